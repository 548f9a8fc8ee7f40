"""What Pinocchio's own readers make of a file, as a description."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import symofros as sf

from .urdf import parser_messages


def description(path: Path, floating_base: bool) -> sf.System:
    """A file as Pinocchio reads it: joints, inertias with the welded links', frames of links, limits, armatures.

    Raises:
        ValueError: Pinocchio refuses the file, or it has joints that are not stated here.
    """
    root = (pin.JointModelFreeFlyer(),) if floating_base else ()
    if path.suffix.lower() == ".xml":
        model: Any = pin.buildModelFromMJCF(str(path), *root)
    else:
        with parser_messages():  # What it refuses it raises, too.
            model = pin.buildModelFromUrdf(str(path), *root)
    links: dict[int, list[Any]] = {k: [] for k in range(model.njoints)}
    for frame in model.frames:
        if frame.type == pin.FrameType.BODY:
            links[frame.parentJoint].append(frame)
    names = {0: "world"} | {k: _name(model, links, k) for k in range(1, model.njoints)}
    bodies = []
    for k in range(model.njoints):
        if k:
            joint = _joint(model, k, names[model.parents[k]])
            bodies.append(sf.RigidBody(names[k], joint, _inertia(model.inertias[k]), waive=tuple(_WAIVED)))
        for frame in links[k]:
            if frame.name not in (names[k], "universe"):
                position, rotation = _placed(frame.placement)
                fixed = sf.Joint(f"{frame.name}_fixed", "fixed", names[k], None, position, rotation)
                bodies.append(sf.RigidBody(frame.name, fixed, waive=tuple(_WAIVED)))
    gravity = tuple(map(float, model.gravity.linear))
    return sf.System(model.name or path.stem, tuple(bodies), gravity=gravity)  # type: ignore[arg-type]


_WAIVED = ("massless_tip", "nonphysical_inertia")


def _name(model: Any, links: dict[int, list[Any]], k: int) -> str:
    """The link that a joint carries."""
    return next((frame.name for frame in links[k] if frame.placement.isIdentity(1e-12)), f"{model.names[k]}_link")


def _inertia(inertia: Any) -> sf.Inertia:
    I = inertia.inertia  # noqa: E741
    moments = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2])
    return sf.Inertia(float(inertia.mass), tuple(map(float, inertia.lever)), tuple(map(float, moments)))  # type: ignore[arg-type]


def _placed(placement: Any) -> tuple[tuple[float, float, float], sf.Rotation]:
    x, y, z = map(float, placement.translation)
    return (x, y, z), sf.Rotation("matrix", tuple(map(float, np.ravel(placement.rotation))))


def _joint(model: Any, k: int, parent: str) -> sf.Joint:
    """A joint by the motion that it allows at its neutral configuration."""
    joint = model.joints[k]
    data = joint.createData()
    joint.calc(data, pin.neutral(model))
    S = np.asarray(data.S).reshape(6, joint.nv)
    position, rotation = _placed(model.jointPlacements[k])
    if joint.nv == 1:
        turns = bool(np.any(S[3:, 0]))
        limits = None if joint.nq == 2 else _limits(model, joint)
        axis, armature = tuple(map(float, S[3:, 0] if turns else S[:3, 0])), float(model.armature[joint.idx_v])
        kind = "revolute" if turns else "prismatic"
        at: dict[str, Any] = {"position": position, "rotation": rotation, "axis": axis}
        return sf.Joint(model.names[k], kind, parent, limits=limits, armature=armature, **at)  # type: ignore[arg-type]
    kinds: dict[tuple[int, int], Any] = {(4, 3): "ball", (7, 6): "free"}
    if (joint.nq, joint.nv) not in kinds:
        raise ValueError(f"joint '{model.names[k]}' is a {joint.shortname()}")
    return sf.Joint(model.names[k], kinds[joint.nq, joint.nv], parent, None, position, rotation)


def _limits(model: Any, joint: Any) -> sf.Limits:
    lower, upper = float(model.lowerPositionLimit[joint.idx_q]), float(model.upperPositionLimit[joint.idx_q])
    velocity, effort = (float(x[joint.idx_v]) for x in (model.upperVelocityLimit, model.upperEffortLimit))
    return sf.Limits(*(None if abs(x) > 1e300 else x for x in (lower, upper, velocity, effort)))
