"""MuJoCo: models by its XML, joints of its own, several to a body."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from validation.engines.interface import Array, Difference, Joint, Slot, Tree, Unsupported
from validation.engines.plugins.source import Source, SourcePlugin, Way, series

# Kind of a joint -> elements (type, axis), chart, coordinates, speeds.
_CHARTS: dict[str, tuple[str, int, int]] = {
    "revolute": ("angle", 1, 1),
    "prismatic": ("length", 1, 1),
    "universal": ("two angles", 2, 2),
    "euler": ("three angles", 3, 3),
    "translation": ("three lengths", 3, 3),
    "ball": ("quaternion wxyz, body speeds", 4, 3),
    "free": ("free wxyz, linear before and angular after", 7, 6),
}


def _text(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _elements(joint: Joint) -> list[tuple[str, Array]]:
    """MuJoCo's joints for one of ours: type and axis."""
    unit = np.eye(3)
    match joint.kind:
        case "revolute":
            return [("hinge", np.array(joint.axis))]
        case "prismatic":
            return [("slide", np.array(joint.axis))]
        case "universal":
            return [("hinge", np.array(joint.axis)), ("hinge", np.array(joint.second))]
        case "euler":
            return [("hinge", unit["XYZ".index(letter)]) for letter in joint.sequence]
        case "translation":
            return [("slide", axis) for axis in unit]
        case _:
            return [(joint.kind, unit[2])]


def _frame(R: Array, p: Array) -> str:
    return f'pos="{_text(p)}" xyaxes="{_text([*R[:, 0], *R[:, 1]])}"'


def document(tree: Tree) -> tuple[str, tuple[tuple[Slot, ...], ...], int, int] | Unsupported:
    """MJCF of a tree, with the slots of its joints, nq and nv.

    MuJoCo numbers joints depth first, so links must stand in that order to have their slots in series; others are found
    by walking.
    """
    opened: dict[int, str] = {}
    children: dict[int, list[int]] = {k: [] for k in range(-1, len(tree.links))}
    for k, link in enumerate(tree.links):
        children[link.parent].append(k)
    slots: dict[int, tuple[Slot, ...]] = {}
    counted = [0, 0]

    def body(k: int) -> str | Unsupported:
        link = tree.links[k]
        steps, (R_end, p_end) = series(link.joints)
        if not steps:
            R, p = R_end, p_end
        elif not np.array_equal(R_end, np.eye(3)) or np.any(p_end):
            return Unsupported("a link's frame stands at its joints", offered=False)
        else:
            R, p = steps[0][0], steps[0][1]
        own, elements = [], []
        for number, (R_step, p_step, joint) in enumerate(steps):
            if joint.kind not in _CHARTS or joint.form or joint.mimics:
                return Unsupported(f"no joint of kind {joint.kind} {joint.form}".strip(), offered=False)
            if number and (not np.array_equal(R_step, np.eye(3)) or np.any(p_step)):
                return Unsupported("joints of one body share its frame", offered=False)
            if joint.kind == "free" and (link.parent >= 0 or not np.array_equal(R, np.eye(3)) or np.any(p)):
                return Unsupported("a free joint stands in the world", offered=False)
            chart, nq, nv = _CHARTS[joint.kind]
            own.append(
                Slot(chart, tuple(range(counted[0], counted[0] + nq)), tuple(range(counted[1], counted[1] + nv)))
            )
            counted[0], counted[1] = counted[0] + nq, counted[1] + nv
            armature = f' armature="{joint.armature[0]!r}"' if joint.armature else ""
            for kind, axis in _elements(joint):
                about = f' axis="{_text(axis)}"' if kind in ("hinge", "slide") else ""
                elements.append(f'<joint type="{kind}"{about}{armature}/>')
        slots[k] = tuple(own)
        inertia = np.array(link.inertia)
        entries = _text(inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        inertial = f'<inertial pos="{_text(link.com)}" mass="{link.mass!r}" fullinertia="{entries}"/>'
        inner = [inertial if link.mass else "", *elements]
        for child in children[k]:
            text = body(child)
            if isinstance(text, Unsupported):
                return text
            inner.append(text)
        return f'<body name="{link.name}" {_frame(R, p)}>' + "".join(inner) + "</body>"

    for root in children[-1]:
        text = body(root)
        if isinstance(text, Unsupported):
            return text
        opened[root] = text
    bodies = "\n".join(opened.values())
    option = f'<option gravity="{_text(tree.gravity)}"/>'
    xml = f'<mujoco><compiler angle="radian"/>{option}<worldbody>\n{bodies}\n</worldbody></mujoco>'
    return xml, tuple(slots[k] for k in range(len(tree.links))), counted[0], counted[1]


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    made = document(tree)
    if isinstance(made, Unsupported):
        return made
    xml, slots, nq, nv = made
    lines = [
        "import numpy as np",
        "import mujoco as mj",
        f"m = mj.MjModel.from_xml_string('''{xml}''')",
        "d = mj.MjData(m)",
    ]
    return Source(tuple(lines), slots, nq, nv)


_SET = "d.qpos[:], d.qvel[:] = q, v\n"
WAYS = {
    "mass_matrix": Way(
        "mj_fullM", "d.qpos[:] = q\nmj.mj_forward(m, d)\nvalue = np.zeros((m.nv, m.nv))\nmj.mj_fullM(m, d, value)"
    ),
    "bias": Way("qfrc_bias", f"{_SET}mj.mj_forward(m, d)\nvalue = d.qfrc_bias"),
    "inverse_dynamics": Way("mj_inverse", f"{_SET}d.qacc[:] = a\nmj.mj_inverse(m, d)\nvalue = d.qfrc_inverse"),
    "inverse_dynamics:mj_rne": Way(
        "mj_rne",
        f"{_SET}d.qacc[:] = a\nmj.mj_forward(m, d)\nd.qacc[:] = a\nvalue = np.zeros(m.nv)\nmj.mj_rne(m, d, 1, value)",
    ),
    "forward_dynamics": Way("mj_forward", f"{_SET}d.qfrc_applied[:] = tau\nmj.mj_forward(m, d)\nvalue = d.qacc"),
    "kinetic_energy": Way("mj_energyVel", f"{_SET}mj.mj_forward(m, d)\nmj.mj_energyVel(m, d)\nvalue = d.energy[1]"),
    "potential_energy": Way(
        "mj_energyPos", "d.qpos[:] = q\nmj.mj_forward(m, d)\nmj.mj_energyPos(m, d)\nvalue = d.energy[0]"
    ),
    "mass_matrix_inverse": Way(
        "mj_solveM",
        "d.qpos[:] = q\nmj.mj_forward(m, d)\nvalue = np.zeros((m.nv, m.nv))\nmj.mj_solveM(m, d, value, np.eye(m.nv))",
    ),
}

PLUGIN = SourcePlugin(
    name="mujoco",
    package="mujoco",
    extra="mujoco",
    conventions=(
        Difference("quaternion", "w, x, y, z"),
        Difference("free joint", "linear velocity in world axes, angular velocity in the axes of the body"),
        Difference("armature", "part of the mass matrix; mj_rne leaves it out"),
    ),
    kinds={},
    ways=WAYS,
    write=write,
)
