"""Mechanisms that hold and let go: an arm that grasps, and what docks."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import symofros as sf

SIDE = sf.Inertia(1.0, (0.5, 0.02, 0.01), (0.01, 0.1, 0.11))
_AXES = ("x", "y", "z")
# Of an arm that holds its target for a while.
PLAN = {
    "grab": sf.Event("t - 0.0203", action={"grip": 1}, once=True),
    "drop": sf.Event("t - 0.04", action={"grip": "1 - grip", "dq1": 0.1}),
}


def grabbing(pose: str = "", *, closed: bool = True, flexible: bool = False, noise: float = 0.0) -> sf.System:
    """An arm on a free base and a free target without weight, which the tip of the arm may hold.

    Args:
        pose: That the switch of the closure states; "" for none.
        closed: Whether there is a closure.
        flexible: Whether the outer link is a beam.
        noise: By which the rotation of the target's handle is no rotation about z alone.
    """
    end = sf.Frame("end", (1, 0, 0))
    base = sf.RigidBody("base", sf.Joint("root", "free"), sf.Inertia(5.0, (0.1, 0, 0), (1, 2, 3)), (end,))
    shoulder = sf.Joint("q1", "revolute", "base", axis=(0, 0, 1), frame="end")
    elbow = sf.Joint("q2", "revolute", "upper", axis=(0, 1, 0), frame="end")
    fore: Any = sf.RigidBody("fore", elbow, SIDE, (sf.Frame("tip", (1, 0, 0)),))
    if flexible:
        fore = sf.Beam("fore", elbow, 1.0, 1.0, EI_z=50.0, bend_y=2, retain="all")
    handle = sf.Frame("handle", (0.2, 0.1, -0.05), sf.Rotation.rpy(noise, -noise, 0.7))
    target = sf.RigidBody(
        "target", sf.Joint("f", "free"), sf.Inertia("m", (0.1, 0.05, -0.03), (0.3, 0.2, 0.25)), (handle,)
    )
    held = sf.Closure("grasp", ("fore", "tip"), ("target", "handle"), rotations=_AXES)
    return sf.System(
        "grabbing",
        (base, sf.RigidBody("upper", shoulder, SIDE, (end,)), fore, target),
        (sf.Parameter("m", 2.0), sf.Parameter("grip", 0.0)),
        gravity=(0, 0, 0),
        constraints=(held,) if closed else (),
        switches=(sf.Switch("grasp", "grip", pose),) if pose else (),  # type: ignore[arg-type]
    )


@cache
def model_of(**options: Any) -> sf.Model:
    """Model of the grasp."""
    return sf.compile(grabbing(**options))


def tumbling(model: sf.Model, seed: int = 1) -> tuple[Any, Any]:
    """A state in which nothing is held."""
    q, v = model.random_state(np.random.default_rng(seed))
    return q, v


@cache
def docking() -> tuple[sf.Model, Any, Any]:
    """A start from which the frames are at their stated relative pose after 5 ms of free motion, at unlike speeds."""
    model = model_of(pose="stated")
    q, v = model.neutral(), np.zeros(model.nv)
    q[model.names.q.index("q2")] = 0.4
    shut = sf.assemble(model, q, par=model.checked_parameters({**model.parameters, "grip": 1.0})).q
    v = np.random.default_rng(2).uniform(-1, 1, model.nv)
    back = sf.simulate(model, shut, -v, 5e-3, dt=1e-4)
    return model, back.q[-1], -back.v[-1]
