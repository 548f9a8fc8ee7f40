"""PyTorch: batches of tensors with autograd; ours and adam."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

import symofros as sf

from ..mechanics.geometry import Array
from ..timing.task import flat
from .record import OURS
from .sides import Environment, Offer, Peer, Side, Subject, plain

# Of tensors (n, nv): q, v, and u or a.
Function = Callable[[Any, Any, Any], Any]


def _torch() -> Any:
    torch = import_module("torch")
    torch.set_num_threads(1)
    return torch


def _offer(who: str, values: Callable[[Subject], dict[str, Function]], subject: Subject) -> Offer:
    torch, values_of = _torch(), values(subject)

    def offer(function: str, states: int) -> Side | None:
        value = values_of.get(plain(function))
        if value is None:
            return None
        given = [torch.tensor(x) for x in subject.at(function, states)]
        if function.endswith("_vjp"):
            *arguments, cotangent = (x.requires_grad_() for x in given)

            def call() -> Any:
                return torch.autograd.grad((cotangent.detach() * value(*arguments)).sum(), arguments)
        elif function.endswith("_derivatives"):
            slopes = torch.func.vmap(torch.func.jacrev(value, argnums=(0, 1, 2)))

            def call() -> Any:
                return slopes(*given)
        else:

            def call() -> Any:
                with torch.no_grad():
                    return (value(*given),)

        def results() -> Array:
            return flat(*(part.detach().numpy().reshape(states, -1) for part in call()))

        return Side(who, call, results)

    return offer


def _ours(subject: Subject) -> dict[str, Function]:
    dynamics = sf.interop.torch.Dynamics(subject.model)
    return {"forward_dynamics": dynamics.forward_dynamics, "inverse_dynamics": dynamics.inverse_dynamics}


def _adam(subject: Subject) -> dict[str, Function]:
    """Functions of ADAM, its base floating but at rest: M and the bias of the joints, and M solved."""
    torch, adam = _torch(), import_module("adam.pytorch")
    gravity = torch.tensor(subject.gravity, dtype=torch.float64)
    joints = list(subject.model.names.q)
    robot = adam.KinDynComputationsBatch(
        subject.urdf(), joints, device=torch.device("cpu"), dtype=torch.float64, gravity=gravity
    )

    def terms(q: Any, v: Any) -> tuple[Any, Any]:
        base = torch.eye(4, dtype=torch.float64).expand(*q.shape[:-1], 4, 4)
        still = torch.zeros(*q.shape[:-1], 6, dtype=torch.float64)
        bias = robot.bias_force(base, q, still, v).reshape(*q.shape[:-1], -1)
        return robot.mass_matrix(base, q)[..., 6:, 6:], bias[..., 6:]

    def forward(q: Any, v: Any, u: Any) -> Any:
        mass, bias = terms(q, v)
        return torch.linalg.solve(mass, (u - bias).unsqueeze(-1)).squeeze(-1)

    def inverse(q: Any, v: Any, a: Any) -> Any:
        mass, bias = terms(q, v)
        return (mass @ a.unsqueeze(-1)).squeeze(-1) + bias

    return {"forward_dynamics": forward, "inverse_dynamics": inverse}


_CPU = "pip install torch --index-url https://download.pytorch.org/whl/cpu"
_ADAM = "pip install 'symofros[engine-adam]'"
TORCH = Environment(
    "torch",
    "PyTorch",
    Peer(OURS, "torch", "torch", _CPU, partial(_offer, OURS, _ours)),
    (
        "forward_dynamics",
        "inverse_dynamics",
        "forward_dynamics_derivatives",
        "inverse_dynamics_derivatives",
        "forward_dynamics_vjp",
    ),
    (Peer("adam", "adam.pytorch", "adam-robotics", _ADAM, partial(_offer, "adam", _adam)),),
    "Tensors of doubles on one thread; values without autograd, derivatives by `torch.func.jacrev` under `vmap`, "
    "reverse mode by `torch.autograd.grad`. adam's base floats: it gives M and the bias, of which the joints' rows are "
    "taken, and M is solved.",
)
