"""PyTorch: forward and inverse dynamics as differentiable functions of batches of tensors.

    dynamics = sf.interop.torch.Dynamics(model)
    a = dynamics.forward_dynamics(q, v, u)      # (..., nv), float64, on the CPU; a.sum().backward()

Reverse and forward mode, `torch.func` (grad, jacrev, jacfwd, jvp, vmap); derivatives are the model's, exact. They are
not differentiated again.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from symofros.errors import Problem
from symofros.interop.rules import RULES, InteropError, check_model, framework, outputs
from symofros.runtime.model import Model

torch = framework("torch", "torch")
_Function: Any = torch.autograd.Function


class Dynamics:
    """A model's dynamics for PyTorch.

    Args:
        model: Compiled model, whose speeds are the rates of its coordinates.

    Raises:
        InteropError: The model has quaternions, prescribed motions or forces that depend on time.
    """

    def __init__(self, model: Model) -> None:
        check_model(model)
        self.model = model

    def forward_dynamics(self, q: Any, v: Any, u: Any, par: Any = None) -> Any:
        """Accelerations (..., nv) of tensors q (..., nq), v (..., nv), u (..., nu), par (..., npar)."""
        return self._apply("forward_dynamics", q, v, u, par)

    def inverse_dynamics(self, q: Any, v: Any, a: Any, par: Any = None) -> Any:
        """Efforts M a + h - Q(q, v, 0) (..., nv) of tensors q, v, a (..., nv) and par (..., npar)."""
        return self._apply("inverse_dynamics", q, v, a, par)

    def _apply(self, name: str, *arrays: Any) -> Any:
        given = [x for x in arrays if x is not None]
        for label, x in zip(RULES[name].inputs, arrays, strict=True):
            if x is not None and (x.dtype != torch.float64 or x.device.type != "cpu"):
                raise InteropError(
                    Problem(
                        f"{name}: '{label}' can't be taken",
                        f"{x.dtype} on {x.device}",
                        "tensors of float64 on the CPU",
                        f"{label}.double().cpu()",
                    )
                )
        batch = torch.broadcast_shapes(*(x.shape[:-1] for x in given))
        expanded = [None if x is None else x.expand(*batch, x.shape[-1]) for x in arrays]
        return _Value.apply(self.model, name, *expanded)


def _numpy(name: str, tensors: tuple[Any, ...]) -> dict[str, Any]:
    """Arrays by name; parameters that were expanded are one set again."""
    named = {key: x.detach().numpy() for key, x in zip(RULES[name].inputs, tensors, strict=True) if x is not None}
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
    def forward(model: Model, name: str, *tensors: Any) -> Any:
        output = next(iter(outputs(model, name, _numpy(name, tensors)).values()))
        return torch.from_numpy(output)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        ctx.model, ctx.name, *tensors = inputs
        ctx.save_for_backward(*tensors)
        ctx.save_for_forward(*tensors)

    @staticmethod
    def backward(ctx: Any, grad: Any) -> tuple[Any, ...]:
        needs = ctx.needs_input_grad[2:]
        slopes = iter(_Slopes.apply(ctx.model, ctx.name, needs, *ctx.saved_tensors))
        return None, None, *(_times(next(slopes).mT, grad) if need else None for need in needs)

    @staticmethod
    def jvp(ctx: Any, _model: None, _name: None, *tangents: Any) -> Any:
        needs = tuple(tangent is not None for tangent in tangents)
        slopes = _Slopes.apply(ctx.model, ctx.name, needs, *ctx.saved_tensors)
        moved = [tangent for tangent in tangents if tangent is not None]
        return sum(_times(slope, tangent) for slope, tangent in zip(slopes, moved, strict=True))

    @staticmethod
    def vmap(info: Any, in_dims: tuple[Any, ...], model: Model, name: str, *tensors: Any) -> tuple[Any, int]:
        return _Value.apply(model, name, *_batched(info, in_dims[2:], tensors)), 0


class _Slopes(_Function):  # type: ignore[misc]
    """The derivatives of a function by those inputs that are needed."""

    @staticmethod
    def forward(model: Model, name: str, needs: tuple[bool, ...], *tensors: Any) -> tuple[Any, ...]:
        given, made = _numpy(name, tensors), dict[str, Mapping[str, np.ndarray[Any, Any]]]()
        slopes = []
        for need, (function, output) in zip(needs, RULES[name].derivatives.values(), strict=True):
            if need:
                if function not in made:
                    made[function] = outputs(model, function, given)
                batch = tensors[0].shape[:-1]
                slope = made[function][output][..., : model.nv, :]
                slopes.append(torch.from_numpy(np.array(np.broadcast_to(slope, (*batch, *slope.shape[-2:])))))
        return tuple(slopes)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        pass

    @staticmethod
    def backward(ctx: Any, *grads: Any) -> tuple[Any, ...]:
        raise _second()

    @staticmethod
    def jvp(ctx: Any, *tangents: Any) -> Any:
        raise _second()

    @staticmethod
    def vmap(
        info: Any, in_dims: tuple[Any, ...], model: Model, name: str, needs: tuple[bool, ...], *tensors: Any
    ) -> tuple[Any, Any]:
        slopes = _Slopes.apply(model, name, needs, *_batched(info, in_dims[3:], tensors))
        return slopes, (0,) * len(slopes)


def _second() -> InteropError:
    return InteropError(
        Problem(
            "second derivatives of the dynamics are not available",
            "a derivative is differentiated again",
            "models have exact first derivatives",
            "use methods of first order, such as Gauss-Newton",
        )
    )
