"""JAX: jitted functions, mapped over states by `vmap`; ours, frax and MJX."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf

from ..mechanics.geometry import Array
from ..timing.task import flat
from .record import OURS
from .sides import Environment, Offer, Peer, Side, Subject, plain

# Of one state: q, v, and u or a -> what is computed.
Function = Callable[[Any, Any, Any], Any]


def _jax() -> Any:
    jax = import_module("jax")
    jax.config.update("jax_enable_x64", True)
    return jax


def transformed(jax: Any, values: dict[str, Function], function: str) -> Callable[..., Any] | None:
    """A function of one state made of the plain ones: derivatives by forward mode, gradients by reverse mode."""
    base = plain(function)
    value = values.get(base)
    if value is None or function == base:
        return value
    if function.endswith("_derivatives"):
        slopes: Callable[..., Any] = jax.jacfwd(value, argnums=(0, 1, 2))
        return slopes
    gradient: Callable[..., Any] = jax.grad(lambda q, v, w, c: c @ value(q, v, w), argnums=(0, 1, 2))
    return gradient


def _offer(
    who: str, values: Callable[[Subject], dict[str, Function]], subject: Subject, plain_only: bool = False
) -> Offer:
    jax, values_of = _jax(), values(subject)

    def offer(function: str, states: int) -> Side | None:
        own = transformed(jax, values_of, function)
        if own is None or (plain_only and (states > 1 or function not in values_of)):
            return None
        compiled = jax.jit(own if states == 1 else jax.vmap(own))
        given = [jax.numpy.asarray(x[0] if states == 1 else x) for x in subject.at(function, states)]

        def call() -> Any:
            return jax.block_until_ready(compiled(*given))

        def results() -> Array:
            value = call()
            parts = value if isinstance(value, tuple) else (value,)
            return flat(*(np.asarray(part).reshape(states, -1) for part in parts))

        return Side(who, call, results)

    return offer


def _ours(subject: Subject) -> dict[str, Function]:
    dynamics = sf.interop.jax.Dynamics(subject.model)
    return {"forward_dynamics": dynamics.forward_dynamics, "inverse_dynamics": dynamics.inverse_dynamics}


def _frax(subject: Subject) -> dict[str, Function]:
    frax: Any = import_module("frax")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.urdf"
        file.write_text(subject.urdf(), encoding="utf-8")
        robot = frax.Robot(str(file), joint_ordering=list(subject.model.names.q))
    upwards = -np.array(subject.gravity)
    return {
        "forward_dynamics": lambda q, v, u: robot.forward_dynamics(q, v, u, None),
        "inverse_dynamics": lambda q, v, a: robot.rnea(q, v, a, upwards, None),
    }


def _mjx(subject: Subject) -> dict[str, Function]:
    """The calls that M and the bias need, without collisions and constraints, and M solved by Cholesky."""
    jax, mjx, mujoco = _jax(), import_module("mujoco.mjx"), import_module("mujoco")
    with tempfile.TemporaryDirectory() as folder:
        exported = sf.export(subject.system, "mjcf", folder, name="robot")
        file = next(path for path in exported.files if path.suffix == ".xml")
        described = mujoco.MjModel.from_xml_path(str(file))
    model, empty = mjx.put_model(described), mjx.make_data(described)

    def terms(q: Any, v: Any) -> tuple[Any, Any]:
        data = mjx.com_vel(model, mjx.com_pos(model, mjx.kinematics(model, empty.replace(qpos=q, qvel=v))))
        return mjx.full_m(model, mjx.crb(model, data)), mjx.rne(model, data).qfrc_bias

    def forward(q: Any, v: Any, u: Any) -> Any:
        mass, bias = terms(q, v)
        return jax.scipy.linalg.solve(mass, u - bias, assume_a="pos")

    def inverse(q: Any, v: Any, a: Any) -> Any:
        mass, bias = terms(q, v)
        return mass @ a + bias

    return {"forward_dynamics": forward, "inverse_dynamics": inverse}


JAX = Environment(
    "jax",
    "JAX",
    Peer(OURS, "jax", "jax", "pip install 'symofros[jax]'", partial(_offer, OURS, _ours)),
    (
        "forward_dynamics",
        "inverse_dynamics",
        "forward_dynamics_derivatives",
        "inverse_dynamics_derivatives",
        "forward_dynamics_vjp",
    ),
    (
        Peer("frax", "frax", "frax", "pip install 'symofros[engine-frax]'", partial(_offer, "frax", _frax)),
        Peer(
            "MJX",
            "mujoco.mjx",
            "mujoco-mjx",
            "pip install 'symofros[engine-mjx]'",
            partial(_offer, "MJX", _mjx, plain_only=True),
        ),
    ),
    "All are jitted, and mapped by `vmap` where a call has several states; derivatives are by `jacfwd`, reverse mode "
    "by `grad`. frax and MJX are written in JAX and get the settings of one thread that frax recommends; MJX runs "
    "kinematics, M and bias alone, without collisions, and solves M by Cholesky. It is asked for values of one state a "
    "call: it is made for accelerators, and on a processor many states, and compiling its derivatives, take minutes.",
    {
        "JAX_ENABLE_X64": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false --xla_cpu_scheduler_type=CPU_SCHEDULER_TYPE_MEMORY_OPTIMIZED",
        "FRAX_SUPPRESS_WARNINGS": "1",
    },
)
