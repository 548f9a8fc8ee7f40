"""Newton's articulations by its builder."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...interface import Actuator, Array, Joint, Link, Slot, Tree, Unsupported
from ..writing.source import Source, series
from .ways import AXIS, CENTRES, DRIVEN, IMPORTS, ROTATION

_BALL = "quaternion xyzw, parent speeds"
# Charts in which a pose has one set of coordinates, but for whole turns.
_SINGLE = ("angle", "length", "planar angle", "three lengths")


def _array(values: object) -> str:
    return repr(np.asarray(values, dtype=float).tolist())


def quaternion(R: Array) -> Array:
    """Quaternion (x, y, z, w) of a rotation."""
    w = np.sqrt(max(0.0, 1.0 + np.trace(R))) / 2.0
    if w > 0.1:
        vector = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / (4.0 * w)
        return np.array([*vector, w])
    values, vectors = np.linalg.eigh(R + R.T)
    axis = vectors[:, int(np.argmax(values))]
    angle = np.arctan2(axis @ np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]), np.trace(R) - 1.0)
    return np.array([*(axis * np.sin(angle / 2.0)), np.cos(angle / 2.0)])


def _placement(R: Array, p: Array) -> str:
    numbers = ", ".join(repr(float(x)) for x in quaternion(R))
    return f"wp.transform({_array(p)}, wp.quat({numbers}))"


def _axes(joint: Joint) -> tuple[list[str], list[str], str] | None:
    """Linear and angular axes of a joint with six or fewer, and its chart."""
    own = joint.armature or (0.0,) * 3

    def axis(number: int, along: object) -> str:
        # An axis without `target_ke` and `target_kd` takes the builder's.
        lost = f", damping={joint.damping!r}" if joint.damping else ""
        return f"axis(axis={_array(along)}, armature={own[number]!r}, target_ke=0, target_kd=0{lost})"

    unit = np.eye(3)
    match joint.kind:
        case "revolute":
            return [], [axis(0, joint.axis)], "angle"
        case "prismatic":
            return [axis(0, joint.axis)], [], "length"
        case "universal":
            return [], [axis(0, joint.axis), axis(1, joint.second)], "two angles"
        case "euler":
            turns = (unit["XYZ".index(letter)] for letter in joint.sequence)
            return [], [axis(k, row) for k, row in enumerate(turns)], "three angles"
        case "translation":
            return [axis(k, row) for k, row in enumerate(unit)], [], "three lengths"
        case "ball":
            return [], [axis(k, row) for k, row in enumerate(unit)], _BALL
        case "planar":
            return [axis(0, unit[0]), axis(1, unit[1])], [axis(2, unit[2])], "planar angle"
    return None


def _call(
    link: Link, steps: tuple[tuple[Array, Array, Joint], ...], drive: Actuator | None
) -> tuple[str, list[tuple[str, int, int]]] | str:
    """The joint of a link as a call, and chart, coordinates, speeds of each part; a reason where there is none."""
    if not steps:
        return "b.add_joint_fixed({ends})", []
    _, _, joint = steps[0]
    if any(one.form or one.mimics for _, _, one in steps):
        return "no such form of a joint"
    alone = len(steps) == 1 and joint.kind in ("revolute", "prismatic")
    if any(one.stiffness for _, _, one in steps) and not alone:
        return "springs stand on hinges and slides alone"
    if len(steps) == 1 and joint.kind == "ball":
        armature = joint.armature[0] if joint.armature else 0.0
        if not joint.damping:
            return f"b.add_joint_ball({{ends}}, armature={armature!r})", [(_BALL, 4, 3)]
        _, axes, _ = _axes(joint) or ([], [], "")
        return f"b.add_joint(newton.JointType.BALL, {{ends}}, angular_axes=[{', '.join(axes)}])", [(_BALL, 4, 3)]
    linear: list[str] = []
    angular: list[str] = []
    parts: list[tuple[str, int, int]] = []
    for number, (R, p, one) in enumerate(steps):
        found = _axes(one)
        if found is None or found[2] == _BALL:
            return f"no joint for {one.kind}"
        if number and (np.any(p) or not np.array_equal(R, np.eye(3)) or (found[0] and angular)):
            return "axes of one joint share a frame, linear before angular"
        linear, angular = linear + found[0], angular + found[1]
        parts.append((found[2], len(found[0]) + len(found[1]), len(found[0]) + len(found[1])))
    if alone:
        armature = joint.armature[0] if joint.armature else 0.0
        about = f"axis={_array(joint.axis)}, armature={armature!r}"
        forces = {"damping": joint.damping, "stiffness": joint.stiffness, "rest_q": joint.rest}
        if drive is not None:
            forces |= {"target_ke": -drive.bias[1], "target_kd": -drive.bias[2]}
        about += "".join(f", {name}={value!r}" for name, value in forces.items() if value)
        return f"b.add_joint_{joint.kind}({{ends}}, {about})", parts
    return f"b.add_joint_d6({{ends}}, linear_axes=[{', '.join(linear)}], angular_axes=[{', '.join(angular)}])", parts


# Where servos are to hold their joints, and at what speed.
_PLACE, _SPEED = 0.25, -0.5


def _driven(tree: Tree, slots: list[tuple[Slot, ...]]) -> tuple[str, ...]:
    """What the controls of a step are besides the forces: added to these, places and speeds that servos hold."""
    fed, places, speeds = ([0.0] * sum(len(slot.v) for own in slots for slot in own) for _ in range(3))
    for k, link in enumerate(tree.links):
        for one in tree.actuators:
            if one.link == link.name:
                (at,) = slots[k][0].v
                fed[at], places[at], speeds[at] = one.fed(_PLACE, _SPEED), _PLACE, _SPEED
    return (f"fed, places, speeds = np.array({fed}), np.array({places}), np.array({speeds})",)


def builder(tree: Tree) -> str:
    """A builder, with gravity where it is not the standard one: before 1.1 it was a number."""
    return (
        f"b = newton.ModelBuilder({'' if tree.gravity == Tree('', ()).gravity else f'gravity={list(tree.gravity)!r}'})"
    )


def has_tiny_moments(tree: Tree, text: str) -> bool:
    """Whether a link has mass and a moment of inertia below 1e-6 kg m^2."""
    return any(link.mass and np.linalg.eigvalsh(np.array(link.inertia))[0] < 1e-6 for link in tree.links)


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds an articulation."""
    drives = {one.link: one for one in tree.actuators}
    if not all(one.is_plain and not one.force_limits for one in tree.actuators):
        return Unsupported("forces and servos along joints, without bounds", offered=False)
    if any(joint.force_limits for link in tree.links for joint in link.joints):
        return Unsupported("bounds of joints' forces are none of its solvers'", offered=False)
    lines = [*IMPORTS, builder(tree)]
    slots: list[tuple[Slot, ...]] = []
    nq = nv = 0
    for k, link in enumerate(tree.links):
        body = f"mass={link.mass!r}, com={list(link.com)!r}, inertia=wp.mat33({_array(link.inertia)})"
        lines.append(f"b{k} = b.add_link({body}, lock_inertia=True)")
    joints = []
    for k, link in enumerate(tree.links):
        steps, (R_end, p_end) = series(link.joints)
        made: Any = _call(link, steps, drives.get(link.name))
        if isinstance(made, str):
            return Unsupported(made, offered=False)
        call, parts = made
        R, p = (steps[0][0], steps[0][1]) if steps else (R_end, p_end)
        parent = "-1" if link.parent < 0 else f"b{link.parent}"
        ends = f"{parent}, b{k}"
        if np.any(p) or not np.array_equal(R, np.eye(3)):
            ends += f", parent_xform={_placement(R, p)}"
        if steps and (np.any(p_end) or not np.array_equal(R_end, np.eye(3))):
            ends += f", child_xform={_placement(R_end.T, -R_end.T @ p_end)}"
        if "=[axis(" in call and AXIS not in lines:
            lines.append(AXIS)
        lines.append(f"j{k} = {call.format(ends=ends)}")
        joints.append(f"j{k}")
        own = []
        for chart, coordinates, speeds in parts:
            own.append(Slot(chart, tuple(range(nq, nq + coordinates)), tuple(range(nv, nv + speeds))))
            nq, nv = nq + coordinates, nv + speeds
        slots.append(tuple(own))
    lines += [f"b.add_articulation([{', '.join(joints)}])", 'm = b.finalize(device="cpu")']
    optional = {"rotation": ROTATION, "centres": CENTRES} | ({"fed": _driven(tree, slots)} if drives else {})
    # What it keeps of arms is that of files.
    lacks: tuple[str, ...]
    lacks, spelling = (("actuator_arms",), DRIVEN) if drives else ((), {})
    if any(slot.chart not in _SINGLE for own in slots for slot in own):  # Of others the same pose has several.
        lacks += ("coordinates_of_links",)
    return Source(tuple(lines), tuple(slots), nq, nv, optional, lacks, spelling=spelling)
