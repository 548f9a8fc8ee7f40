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

from symofros.interop.coordinates import Operations
from symofros.interop.rules import RULES, InteropError, framework, outputs, second_derivatives
from symofros.interop.wrapped import WrappedDynamics
from symofros.runtime.model import Model

torch = framework("torch", "torch")
_Function: Any = torch.autograd.Function
_OPERATIONS = Operations(
    lambda x: x.unbind(-1),
    lambda entries: torch.stack(torch.broadcast_tensors(*entries), dim=-1),
    *(torch.sqrt, torch.sin, torch.cos, torch.arctan2, torch.where),
)


class Dynamics(WrappedDynamics):
    """A model's dynamics for PyTorch.

    Args:
        model: Compiled model.

    Raises:
        InteropError: The model has prescribed motions or forces that depend on time.
    """

    def __init__(self, model: Model) -> None:
        super().__init__(model, _OPERATIONS)

    def _apply(self, name: str, *tensors: Any) -> Any:
        given = self._given(name, **dict(zip(RULES[name].inputs, tensors, strict=True)))
        if torch.compiler.is_compiling():
            return torch.compiler.disable(_evaluated)(self, name, given)  # A compiled program calls C as it stands.
        return _evaluated(self, name, given)

    def _given(self, function: str, **given: Any) -> list[Any]:
        """Tensors of doubles with the same leading dimensions; None stays."""
        for label, x in given.items():
            tensor = isinstance(x, torch.Tensor)
            if x is None and label == "par":
                continue
            if not tensor or x.dtype != torch.float64 or x.device.type != "cpu":
                raise InteropError(
                    f"{function}: '{label}' can't be taken",
                    f"{x.dtype} on {x.device}" if tensor else type(x).__name__,
                    "tensors of float64 on the CPU",
                    f"{label}.double().cpu()" if tensor else f"torch.as_tensor({label}, dtype=torch.float64)",
                )
            self._check_shape(function, label, tuple(x.shape))
        batch = torch.broadcast_shapes(*(x.shape[:-1] for x in given.values() if x is not None))
        return [None if x is None else x.expand(*batch, x.shape[-1]) for x in given.values()]


def _evaluated(of: Dynamics, name: str, given: list[Any]) -> Any:
    return _Value.apply(of, name, *given)


def _numpy(of: Dynamics, name: str, tensors: tuple[Any, ...]) -> dict[str, Any]:
    """Arrays by name, at unit quaternions; parameters that were expanded are one set again."""
    q, *others = tensors
    at = (of.coordinates.unit(q), *others)
    named = {
        key: x.detach().resolve_neg().numpy() for key, x in zip(RULES[name].inputs, at, strict=True) if x is not None
    }
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
        slopes = iter(_Derivatives.apply(ctx.of, ctx.name, needs, *ctx.saved_tensors))
        return None, None, *(_times(next(slopes).mT, grad) if need else None for need in needs)

    @staticmethod
    def jvp(ctx: Any, _model: None, _name: None, *tangents: Any) -> Any:
        needs = tuple(tangent is not None for tangent in tangents)
        slopes = _Derivatives.apply(ctx.of, ctx.name, needs, *ctx.saved_tensors)
        moved = [tangent for tangent in tangents if tangent is not None]
        return sum(_times(slope, tangent) for slope, tangent in zip(slopes, moved, strict=True))

    @staticmethod
    def vmap(info: Any, in_dims: tuple[Any, ...], of: Dynamics, name: str, *tensors: Any) -> tuple[Any, int]:
        return _Value.apply(of, name, *_batched(info, in_dims[2:], tensors)), 0


class _Derivatives(_Function):  # type: ignore[misc]
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
        slopes = _Derivatives.apply(of, name, needs, *_batched(info, in_dims[3:], tensors))
        return slopes, (0,) * len(slopes)
