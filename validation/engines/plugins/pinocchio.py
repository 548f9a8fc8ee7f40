"""Pinocchio: every joint model of its own API."""

from __future__ import annotations

from typing import Any

import numpy as np

from validation.engines.interface import Array, Difference, Joint, Slot, Tree, Unsupported
from validation.engines.plugins.source import Source, SourcePlugin, Way, series

# Kind and form of a joint -> joint model, chart, coordinates, speeds. {axis} is X, Y or Z where the axis is one of
# them.
_MODELS: dict[tuple[str, str], tuple[str, str, int, int]] = {
    ("revolute", ""): ("RevoluteUnaligned({axis})", "angle", 1, 1),
    ("revolute", "unbounded"): ("RevoluteUnboundedUnaligned({axis})", "cos sin", 2, 1),
    ("prismatic", ""): ("PrismaticUnaligned({axis})", "length", 1, 1),
    ("helical", ""): ("HelicalUnaligned({axis}, {pitch!r})", "screw angle", 1, 1),
    ("universal", ""): ("Universal({axis}, {second})", "two angles", 2, 2),
    ("euler", ""): ("SphericalZYX()", "three angles", 3, 3),
    ("translation", ""): ("Translation()", "three lengths", 3, 3),
    ("ball", ""): ("Spherical()", "quaternion xyzw, body speeds", 4, 3),
    ("free", ""): ("FreeFlyer()", "free xyzw, body speeds", 7, 6),
    ("planar", ""): ("Planar()", "planar cos sin, body speeds", 4, 3),
    ("ellipsoid", ""): ("Ellipsoid({radii})", "ellipsoid angles", 3, 3),
}
_ALIGNED = {
    ("revolute", ""): "R{letter}()",
    ("revolute", "unbounded"): "RUB{letter}()",
    ("prismatic", ""): "P{letter}()",
    ("helical", ""): "H{letter}({pitch!r})",
}


def _array(values: Any) -> str:
    return f"np.array({np.asarray(values, dtype=float).tolist()!r})"


def _placement(R: Array, p: Array) -> str:
    if np.array_equal(R, np.eye(3)) and not np.any(p):
        return "pin.SE3.Identity()"
    return f"pin.SE3({_array(R)}, {_array(p)})"


def _model(joint: Joint) -> str | Unsupported:
    """The text of a joint's model."""
    key = (joint.kind, joint.form)
    if key not in _MODELS or (joint.kind == "euler" and joint.sequence != "ZYX"):
        return Unsupported(f"no joint model for {joint.kind} {joint.form or joint.sequence}", offered=False)
    letter = next((name for name, unit in zip("XYZ", np.eye(3), strict=True) if tuple(unit) == joint.axis), "")
    text = _ALIGNED[key] if letter and key in _ALIGNED else _MODELS[key][0]
    axis, second = _array(joint.axis), _array(joint.second)
    radii = ", ".join(map(repr, joint.radii))
    return "pin.JointModel" + text.format(letter=letter, axis=axis, second=second, radii=radii, pitch=joint.pitch)


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    lines = ["import numpy as np", "import pinocchio as pin", "m = pin.Model()"]
    lines.append(f"m.gravity.linear = {_array(tree.gravity)}")
    slots: list[tuple[Slot, ...]] = []
    # For each link: variable of its Pinocchio joint, and its placement there.
    places: list[tuple[str, Array, Array]] = []
    ids = {link.name: k for k, link in enumerate(tree.links)}
    nq = nv = 0
    armature: list[float] = []
    for k, link in enumerate(tree.links):
        parent, R0, p0 = places[link.parent] if link.parent >= 0 else ("0", np.eye(3), np.zeros(3))
        steps, (R_end, p_end) = series(link.joints)
        own: list[Slot] = []
        models: list[tuple[str, str]] = []
        for number, (R, p, joint) in enumerate(steps):
            model = _model(joint)
            if isinstance(model, Unsupported):
                return model
            _, chart, coordinates, speeds = _MODELS[joint.kind, joint.form]
            if joint.mimics:
                followed = ids[joint.mimics]
                model = f"pin.JointModelMimic({model}, m.joints[j{followed}], {joint.ratio!r}, {joint.offset!r})"
                own.append(Slot(chart, slots[followed][0].q, slots[followed][0].v))
            else:
                own.append(Slot(chart, tuple(range(nq, nq + coordinates)), tuple(range(nv, nv + speeds))))
                nq, nv = nq + coordinates, nv + speeds
                armature += joint.armature or (0.0,) * speeds
            if number == 0:
                R, p = R0 @ R, p0 + R0 @ p
            models.append((model, _placement(R, p)))
        if not models:
            places.append((parent, R0 @ R_end, p0 + R0 @ p_end))
        else:
            model, placement = models[0]
            if len(models) > 1:
                lines.append("c = pin.JointModelComposite()")
                lines += [
                    f"c.addJoint({one}, {where if n else 'pin.SE3.Identity()'})"
                    for n, (one, where) in enumerate(models)
                ]
                model = "c"
            lines.append(f"j{k} = m.addJoint({parent}, {model}, {placement}, {link.name!r})")
            places.append((f"j{k}", R_end, p_end))
        slots.append(tuple(own))
        name, R, p = places[-1]
        inertia = f"pin.Inertia({link.mass!r}, {_array(link.com)}, {_array(link.inertia)})"
        lines.append(f"m.appendBodyToJoint({name}, {inertia}, {_placement(R, p)})")
        lines.append(f"m.addFrame(pin.Frame('f{k}', {name}, 0, {_placement(R, p)}, pin.FrameType.OP_FRAME))")
    if any(armature):
        lines.append(f"m.armature = {_array(armature)}")
    lines.append("d = m.createData()")
    return Source(tuple(lines), tuple(slots), nq, nv)


WAYS = {
    "mass_matrix": Way("crba", "value = pin.crba(m, d, q)"),
    "bias": Way("nonLinearEffects", "value = pin.nonLinearEffects(m, d, q, v)"),
    "gravity": Way("computeGeneralizedGravity", "value = pin.computeGeneralizedGravity(m, d, q)"),
    "inverse_dynamics": Way("rnea", "value = pin.rnea(m, d, q, v, a)"),
    "forward_dynamics": Way("aba", "value = pin.aba(m, d, q, v, tau)"),
    "kinetic_energy": Way("computeKineticEnergy", "value = pin.computeKineticEnergy(m, d, q, v)"),
    "potential_energy": Way("computePotentialEnergy", "value = pin.computePotentialEnergy(m, d, q)"),
    "mass_matrix_inverse": Way("computeMinverse", "value = pin.computeMinverse(m, d, q)"),
}

PLUGIN = SourcePlugin(
    name="pinocchio",
    package="pin",
    extra="pin",
    conventions=(
        Difference("quaternion", "x, y, z, w"),
        Difference("free joint", "linear and angular velocity in the axes of the body"),
        Difference("armature", "m.armature; rotorInertia and rotorGearRatio have no effect on rnea, crba, aba"),
    ),
    kinds={},
    ways=WAYS,
    write=write,
)
