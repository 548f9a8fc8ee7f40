"""Inverse kinematics of arms of any size, stretched and folded, at their limits: Pinocchio's poses of the solution."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ...adapters.pinocchio import tree as pinocchio
from ...contract.interface import States, Subject, Unsupported
from ..attack import (
    Attack,
    Mechanism,
    Scene,
    Verdict,
    along,
    compared,
    decades,
    inertia,
    refused,
    undecided,
    worst,
)

TOLERANCE = 1e-10
ROUNDING = 1e-13
_LIMIT = 2.0


@cache
def arm() -> Mechanism:
    """Six revolute joints, the first three with limits; the last three meet in a wrist."""
    axes = ((0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0))
    reach = (0.0, 0.3, 1.0, 0.8, 0.0, 0.0)
    bodies: list[sf.RigidBody] = []
    for i, (axis, length) in enumerate(zip(axes, reach, strict=True)):
        joint = sf.Joint(
            f"q{i + 1}",
            "revolute",
            bodies[-1].name if bodies else "world",
            position=along(f"{length}*L"),
            axis=axis,
            limits=sf.Limits(-_LIMIT, _LIMIT) if i < 3 else None,
        )
        mass_properties = inertia(1.0, (0, 0, 0), (1.0, 1.0, 1.0))
        frames = (sf.Frame("tool", along("0.1*L")),) if i == 5 else ()
        bodies.append(sf.RigidBody(f"link{i + 1}", joint, mass_properties, frames))
    options = sf.Options(("frame_pose", "frame_jacobian"), ("tool",))
    return Mechanism(sf.System("arm", tuple(bodies), (sf.Parameter("L", 1.0),)), options)


_angles = st.sampled_from([0.3, 0.0, -0.7, 1.5707963, 1.9, -2.0, 1e-4, 3.1])
_scenes = st.fixed_dictionaries(
    {
        "L": decades(-6, 6),
        "goal": st.lists(_angles, min_size=6, max_size=6),
        "guess": st.lists(_angles, min_size=6, max_size=6),
        # Place of the target over that of the posture it is made of: beyond one the arm may be too short.
        "stretch": st.sampled_from([1.0, 1.0, 0.5, 1.2]),
        "turned": st.booleans(),
        "rest": st.booleans(),
    }
)


def judge(scene: Scene) -> Verdict:
    """The solution's pose by Pinocchio, its limits."""
    model, par = arm().model, arm().par(L=scene["L"])
    p, R = model.frame_pose("tool", scene["goal"], par=par)
    p = scene["stretch"] * p
    target = sf.Target(p, R if scene["turned"] else None)
    rest = np.zeros(model.nq) if scene["rest"] else None
    at = sf.inverse_kinematics(model, {"tool": target}, scene["guess"], rest=rest, par=par)
    if not at.converged or at.notes:
        return refused(f"not converged: an error of {at.error:.3g}")
    engine = pinocchio.build(Subject("arm", arm().at(L=scene["L"]), ("tool",)))
    if isinstance(engine, Unsupported):
        return undecided(engine.reason)
    q, none = at.q[np.newaxis], np.zeros((1, 6))
    pose = engine.frame_pose(States(q, none, none, np.zeros((1, 0)), none, none))[0, 0]
    claim = f"converged, with an error of {at.error:.3g}"
    reach = 2.2 * scene["L"]
    verdicts = [
        compared(
            "error of the position over the arm",
            float(np.linalg.norm(pose[:3] - p)) / reach,
            2.0 * TOLERANCE * max(1.0, 1.0 / reach) + ROUNDING,
            claim,
        ),
        compared("excess over a limit", float(np.abs(at.q[:3]).max()) - _LIMIT, 1e-12, claim)
        if np.abs(at.q[:3]).max() > _LIMIT
        else compared("excess over a limit", 0.0, 1e-12, claim),
    ]
    if scene["turned"]:
        apart = float(np.abs(pose[3:].reshape(3, 3) - R).max())
        verdicts.append(compared("error of the rotation", apart, 2.0 * TOLERANCE + ROUNDING, claim))
    return worst(*verdicts)


ATTACK = Attack(
    "inverse_kinematics",
    "a configuration that converged puts the frame where it is wanted, within the limits",
    "Pinocchio's poses",
    _scenes,
    lambda scene: arm().at(L=scene["L"]),
    judge,
)
