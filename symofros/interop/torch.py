"""PyTorch: forward and inverse dynamics as differentiable functions of batches of tensors.

    dynamics = sf.interop.torch.Dynamics(model)
    a = dynamics.forward_dynamics(q, v, u)      # (..., nv), float64, on the CPU; a.sum().backward()
    q = dynamics.integrate(q, dt * v)

Reverse and forward mode, `torch.func` (grad, jacrev, jacfwd, jvp, vmap); derivatives are the model's, exact. They are
not differentiated again. Quaternions may be of any length but zero: functions are those of the unit ones
(docs/theory/linear.md, section 9).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from symofros.errors import Problem
from symofros.interop.coordinates import Coordinates, Operations
from symofros.interop.rules import RULES, InteropError, check_model, framework, outputs, second_derivatives
from symofros.runtime.model import Model

torch = framework("torch", "torch")
_Function: Any = torch.autograd.Function
_OPERATIONS = Operations(
    lambda x: x.unbind(-1),
    lambda entries: torch.stack(torch.broadcast_tensors(*entries), dim=-1),
    *(torch.sqrt, torch.sin, torch.cos, torch.arctan2, torch.where),
)


class Dynamics:
    """A model's dynamics for PyTorch.

    Args:
        model: Compiled model.

    Raises:
        InteropError: The model has prescribed motions or forces that depend on time.
    """

    def __init__(self, model: Model) -> None:
        check_model(model)
        self.model = model.with_precision("double")
        self.coordinates = Coordinates(model.record.segments, _OPERATIONS)

    def forward_dynamics(self, q: Any, v: Any, u: Any, par: Any = None) -> Any:
        """Accelerations (..., nv) of tensors q (..., nq), v (..., nv), u (..., nu), par (..., npar)."""
        return self._apply("forward_dynamics", q, v, u, par)

    def inverse_dynamics(self, q: Any, v: Any, a: Any, par: Any = None) -> Any:
        """Efforts M a + h - Q(q, v, 0) (..., nv) of tensors q, v, a (..., nv) and par (..., npar)."""
        return self._apply("inverse_dynamics", q, v, a, par)

    def coordinate_rates(self, q: Any, v: Any) -> Any:
        """Rates q' = N(q) v (..., nq) of tensors q (..., nq), v (..., nv): v itself but for balls and free joints."""
        return self.coordinates.rates(*self._tensors("coordinate_rates", q=q, v=v))

    def integrate(self, q: Any, dq: Any) -> Any:
        """Move from q (..., nq) along the manifold by dq (..., nv), a velocity times a time: `Model.integrate`."""
        return self.coordinates.integrate(*self._tensors("integrate", q=q, dq=dq))

    def difference(self, q0: Any, q1: Any) -> Any:
        """The dq (..., nv) that leads from q0 to q1 (..., nq): `Model.difference`."""
        return self.coordinates.difference(*self._tensors("difference", q0=q0, q1=q1))

    def _apply(self, name: str, *tensors: Any) -> Any:
        given = self._tensors(name, **dict(zip(RULES[name].inputs, tensors, strict=True)))
        return _Value.apply(self, name, *given)

    def _tensors(self, function: str, **given: Any) -> list[Any]:
        """Tensors of doubles with the same leading dimensions; None stays."""
        sizes = {
            "q": self.model.nq,
            "q0": self.model.nq,
            "q1": self.model.nq,
            "u": self.model.nu,
            "par": self.model.npar,
        }
        for label, x in given.items():
            tensor = isinstance(x, torch.Tensor)
            if x is None and label == "par":
                continue
            if not tensor or x.dtype != torch.float64 or x.device.type != "cpu":
                raise InteropError(
                    Problem(
                        f"{function}: '{label}' can't be taken",
                        f"{x.dtype} on {x.device}" if tensor else type(x).__name__,
                        "tensors of float64 on the CPU",
                        f"{label}.double().cpu()" if tensor else f"torch.as_tensor({label}, dtype=torch.float64)",
                    )
                )
            size = sizes.get(label, self.model.nv)
            if x.ndim == 0 or x.shape[-1] != size:
                shape = str(tuple(x.shape))
                raise InteropError(
                    Problem(f"{function}: '{label}' has the wrong shape", shape, f"(..., {size})", "check its size")
                )
        batch = torch.broadcast_shapes(*(x.shape[:-1] for x in given.values() if x is not None))
        return [None if x is None else x.expand(*batch, x.shape[-1]) for x in given.values()]


def _numpy(of: Dynamics, name: str, tensors: tuple[Any, ...]) -> dict[str, Any]:
    """Arrays by name, at unit quaternions; parameters that were expanded are one set again."""
    q, *others = tensors
    at = (of.coordinates.unit(q), *others)
    named = {key: x.detach().numpy() for key, x in zip(RULES[name].inputs, at, strict=True) if x is not None}
    par = named.get("par")
    if par is not None and par.ndim > 1 and par.size and not any(par.strides[:-1]):
        named["par"] = par[(0,) * (par.ndim - 1)]
    return named


def _batched(info: Any, dims: tuple[Any, ...], tensors: tuple[Any, ...]) -> list[Any]:
    """Tensors with the mapped dimension in front."""
    return [
        x if x is None else x.unsqueeze(0).expand(info.batch_size, *x.shape) if d is None else x.movedim(d, 0)
        for d, x in zip(dims, tensors, strict=True)
    ]


def _times(slope: Any, tangent: Any) -> Any:
    return (slope @ tangent.unsqueeze(-1)).squeeze(-1)


class _Value(_Function):  # type: ignore[misc]
    """A function of a model."""

    @staticmethod
    def forward(of: Dynamics, name: str, *tensors: Any) -> Any:
        return torch.from_numpy(next(iter(outputs(of.model, name, _numpy(of, name, tensors)).values())))

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        ctx.of, ctx.name, *tensors = inputs
        ctx.save_for_backward(*tensors)
        ctx.save_for_forward(*tensors)

    @staticmethod
    def backward(ctx: Any, grad: Any) -> tuple[Any, ...]:
        needs = ctx.needs_input_grad[2:]
        slopes = iter(_Slopes.apply(ctx.of, ctx.name, needs, *ctx.saved_tensors))
        return None, None, *(_times(next(slopes).mT, grad) if need else None for need in needs)

    @staticmethod
    def jvp(ctx: Any, _model: None, _name: None, *tangents: Any) -> Any:
        needs = tuple(tangent is not None for tangent in tangents)
        slopes = _Slopes.apply(ctx.of, ctx.name, needs, *ctx.saved_tensors)
        moved = [tangent for tangent in tangents if tangent is not None]
        return sum(_times(slope, tangent) for slope, tangent in zip(slopes, moved, strict=True))

    @staticmethod
    def vmap(info: Any, in_dims: tuple[Any, ...], of: Dynamics, name: str, *tensors: Any) -> tuple[Any, int]:
        return _Value.apply(of, name, *_batched(info, in_dims[2:], tensors)), 0


class _Slopes(_Function):  # type: ignore[misc]
    """The derivatives of a function by those inputs that are needed."""

    @staticmethod
    def forward(of: Dynamics, name: str, needs: tuple[bool, ...], *tensors: Any) -> tuple[Any, ...]:
        given, batch = _numpy(of, name, tensors), tensors[0].shape[:-1]
        made: dict[str, Mapping[str, np.ndarray[Any, Any]]] = {}
        slopes = []
        for need, (key, (function, output)) in zip(needs, RULES[name].derivatives.items(), strict=True):
            if need:
                if function not in made:
                    made[function] = outputs(of.model, function, given)
                slope = made[function][output][..., : of.model.nv, :]
                tensor = torch.from_numpy(np.array(np.broadcast_to(slope, (*batch, *slope.shape[-2:]))))
                if key == "q":
                    tensor = of.coordinates.by_coordinates(tensors[0].unsqueeze(-2), tensor)
                slopes.append(tensor)
        return tuple(slopes)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        ctx.of, ctx.name, *_ = inputs

    @staticmethod
    def backward(ctx: Any, *grads: Any) -> tuple[Any, ...]:
        raise second_derivatives(ctx.of.model, ctx.name)

    @staticmethod
    def jvp(ctx: Any, *tangents: Any) -> Any:
        raise second_derivatives(ctx.of.model, ctx.name)

    @staticmethod
    def vmap(
        info: Any, in_dims: tuple[Any, ...], of: Dynamics, name: str, needs: tuple[bool, ...], *tensors: Any
    ) -> tuple[Any, Any]:
        slopes = _Slopes.apply(of, name, needs, *_batched(info, in_dims[3:], tensors))
        return slopes, (0,) * len(slopes)
