"""Text that builds a tree by Pinocchio's own API: every joint model, composites, locked joints, joined models."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...interface import Array, End, Joint, Rows, Slot, Tree, Unsupported
from ..writing import copies
from ..writing.numbering import attached
from ..writing.source import Source, series
from . import constraints, objects

# Kind and form of a joint -> joint model, chart, coordinates, speeds. {axis} is X, Y or Z where the axis is one of
# them.
MODELS: dict[tuple[str, str], tuple[str, str, int, int]] = {
    ("revolute", ""): ("RevoluteUnaligned({axis})", "angle", 1, 1),
    ("revolute", "unbounded"): ("", "cos sin", 2, 1),
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

CLOSING = ("d = m.createData()",)


def _array(values: Any) -> str:
    return f"np.array({np.asarray(values, dtype=float).tolist()!r})"


def _placement(R: Array, p: Array) -> str:
    if np.array_equal(R, np.eye(3)) and not np.any(p):
        return "pin.SE3.Identity()"
    return f"pin.SE3({_array(R)}, {_array(p)})"


def _is_possible(inertia: Rows) -> bool:
    """Whether principal moments are non-negative and satisfy the triangle inequality."""
    moments = np.linalg.eigvalsh(np.array(inertia))
    return bool(moments[0] >= 0.0 and 2.0 * moments[2] <= moments.sum())


def _model(joint: Joint) -> str | Unsupported:
    """The text of a joint's model."""
    key = (joint.kind, joint.form)
    if key not in MODELS or (joint.kind == "euler" and joint.sequence != "ZYX"):
        return Unsupported(f"no joint model for {joint.kind} {joint.form or joint.sequence}", offered=False)
    letter = next((name for name, unit in zip("XYZ", np.eye(3), strict=True) if tuple(unit) == joint.axis), "")
    text = _ALIGNED[key] if letter and key in _ALIGNED else MODELS[key][0]
    if not text:
        return Unsupported("in Python, JointModelRevoluteUnboundedUnaligned takes no axis", offered=False)
    axis, second = _array(joint.axis), _array(joint.second)
    radii = ", ".join(map(repr, joint.radii))
    return "pin.JointModel" + text.format(letter=letter, axis=axis, second=second, radii=radii, pitch=joint.pitch)


class _ModelText:
    """Statements that build a tree's model, collected link by link."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.lines = ["import numpy as np", "import pinocchio as pin", "m = pin.Model()"]
        if tree.gravity != (0.0, 0.0, -9.81):
            self.lines.append(f"m.gravity.linear = {_array(tree.gravity)}")
        self.slots: list[tuple[Slot, ...]] = []
        # For each link: variable of its Pinocchio joint, and its placement there.
        self.places: list[tuple[str, Array, Array]] = []
        self.ids = {link.name: k for k, link in enumerate(tree.links)}
        self.nq = self.nv = 0
        self.armature: list[float] = []
        self.frames: list[str] = []
        self.joints: list[str] = []
        self.locked: list[str] = []
        self.own_model = attached(tree)

    def add(self, k: int) -> Unsupported | None:
        """Add a link with its joints, or say what Pinocchio has not of it."""
        link = self.tree.links[k]
        parent, R0, p0 = self._parent(k)
        steps, end = series(link.joints)
        own: list[Slot] = []
        models: list[tuple[str, str]] = []
        for number, (R, p, joint) in enumerate(steps):
            model = self._joint(k, joint, own)
            if isinstance(model, Unsupported):
                return model
            models.append((model, _placement(*((R0 @ R, p0 + R0 @ p) if number == 0 else (R, p)))))
        self.slots.append(tuple(own))
        self.places.append(self._link(k, parent, models, end) if models else (parent, R0 @ end[0], p0 + R0 @ end[1]))
        name, R, p = self.places[-1]
        inertia = f"pin.Inertia({link.mass!r}, {_array(link.com)}, {_array(link.inertia)})"
        if not _is_possible(link.inertia):  # The constructor refuses what files state and the attributes take.
            values = f"{link.mass!r}, {_array(link.com)}, {_array(link.inertia)}"
            self.lines += ["b = pin.Inertia.Zero()", f"b.mass, b.lever, b.inertia = {values}"]
            inertia = "b"
        if not models and k in self.own_model:  # A frame's inertia is its joint's, or that of what the model hangs on.
            body = f"pin.Frame('b{k}', {name}, 0, {_placement(R, p)}, pin.FrameType.BODY, {inertia})"
            self.lines.append(f"m2.addFrame({body})")
        else:
            self.lines.append(f"{self._model_of(k)}.appendBodyToJoint({name}, {inertia}, {_placement(R, p)})")
        frame = f"pin.Frame('f{k}', {name}, 0, {_placement(R, p)}, pin.FrameType.OP_FRAME)"
        self.frames.append(f"{self._model_of(k)}.addFrame({frame})")
        self.joints.append(name if not np.any(p) and np.array_equal(R, np.eye(3)) else "")
        return None

    def _model_of(self, k: int) -> str:
        """Variable of the model that a link is in."""
        return "m2" if k in self.own_model else "m"

    def _parent(self, k: int) -> tuple[str, Array, Array]:
        """Joint that a link hangs on, and its placement there; an attached model begins at its own origin."""
        link, origin = self.tree.links[k], ("0", np.eye(3), np.zeros(3))
        place = self.places[link.parent] if link.parent >= 0 else origin
        if link.name != self.tree.attached:
            return place
        held, R0, p0 = place
        at = f"pin.Frame('at', {held}, 0, {_placement(R0, p0)}, pin.FrameType.OP_FRAME)"
        self.lines += ["m2 = pin.Model()", f"at = m.addFrame({at})"]
        return origin

    def _joint(self, k: int, joint: Joint, own: list[Slot]) -> str | Unsupported:
        """The model of one joint; its slot goes to the link's own."""
        model = _model(joint)
        if isinstance(model, Unsupported):
            return model
        _, chart, coordinates, speeds = MODELS[joint.kind, joint.form]
        if joint.mimics:
            followed = self.ids[joint.mimics]
            indices = f"j{followed}, m.idx_qs[j{followed}], m.idx_vs[j{followed}]"
            self.lines += [f"s{k} = {model}", f"s{k}.setIndexes({indices})"]
            own.append(Slot(chart, self.slots[followed][0].q, self.slots[followed][0].v))
            return f"pin.JointModelMimic(s{k}, {joint.ratio!r}, {joint.offset!r})"
        if joint.locked is not None:
            self.locked += [f"m.joints[j{k}].idx_q", repr(joint.locked)]
            return model
        q, v = range(self.nq, self.nq + coordinates), range(self.nv, self.nv + speeds)
        own.append(Slot(chart, tuple(q), tuple(v)))
        self.nq, self.nv = q.stop, v.stop
        self.armature += joint.armature or (0.0,) * speeds
        return model

    def _link(
        self, k: int, parent: str, models: list[tuple[str, str]], end: tuple[Array, Array]
    ) -> tuple[str, Array, Array]:
        """Add the joints of a link, several as one composite; where the link is."""
        (model, placement), *others = models
        if others:
            parts = [(model, "pin.SE3.Identity()"), *others]
            self.lines.append("c = pin.JointModelComposite()")
            self.lines += [f"c.addJoint({one}, {where})" for one, where in parts]
            model = "c"
        m, name = self._model_of(k), self.tree.links[k].name
        self.lines.append(f"j{k} = {m}.addJoint({parent}, {model}, {placement}, {name!r})")
        if "locked" in self.tree.transformations:
            self.lines.append(f"{m}.addJointFrame(j{k})")
        return f"j{k}", *end

    def place(self, end: End) -> tuple[str, str]:
        """Joint and placement of a constraint's end."""
        joint, R, p = self.places[self.ids[end.link]] if end.link else ("0", np.eye(3), np.zeros(3))
        return joint, _placement(R @ np.array(end.R), p + R @ np.array(end.p))

    def source(self) -> Source:
        """The text with what functions need."""
        tree, lines, slots = self.tree, self.lines, tuple(self.slots)
        if any(self.armature):
            lines.append(f"m.armature = {_array(self.armature)}")
        if tree.transformations:
            lines += [*self.frames, *_transformed(self.locked, len(self.own_model) > 0)]
            named = {"fs": (_NAMED_FRAMES.format(len(tree.links)),)}
            return Source(tuple(lines), slots, self.nq, self.nv, named, closing=CLOSING)
        optional: dict[str, tuple[str, ...]] = {"fs": (f"fs = [{', '.join(self.frames)}]",)}
        if all(self.joints) and len(set(self.joints)) == len(self.joints):
            optional["js"] = (f"js = [{', '.join(self.joints)}]",)
        if tree.sensors:
            made = (f"pin.Frame('o{k}', {{}}, 0, {{}}, pin.FrameType.OP_FRAME)" for k in range(len(tree.sensors)))
            stated = (text.format(*self.place(end)) for text, end in zip(made, tree.sensors, strict=True))
            optional["sensed"] = (f"sensed = [{', '.join(f'm.addFrame({one})' for one in stated)}]", *CLOSING)
        optional |= constraints.optional(tree.constraints, self.place)
        # Mimicking joints that are read again hold what is not set: they crash, or answer by chance.
        lacks = _MIMICS_LACK if any(joint.mimics for link in tree.links for joint in link.joints) else ()
        return Source(tuple(lines), slots, self.nq, self.nv, optional, lacks, CLOSING, of_links="fs")


def _changing(tree: Tree) -> list[str]:
    """Statements that give the model a tree's numbers of what is changed; each link stands at its one joint."""
    if tree.changed == "gravity":
        return [f"m.gravity.linear = {_array(tree.gravity)}"]
    lines = []
    for k, link in enumerate(tree.links):
        joint = link.joints[0]
        if tree.changed == "frame":
            lines.append(f"m.jointPlacements[j{k}] = {_placement(np.array(joint.R), np.array(joint.p))}")
        else:
            lines.append(f"m.inertias[j{k}] = pin.Inertia({link.mass!r}, {_array(link.com)}, {_array(link.inertia)})")
    return lines


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree."""
    if tree.changed:
        first = write(tree.before)
        used = "pin.computeAllTerms(m, d, pin.neutral(m), np.zeros(m.nv))"
        before = _changing(replace(tree.before, changed=tree.changed))
        closing = (*before, *CLOSING, used, *_changing(tree))
        return first if isinstance(first, Unsupported) else replace(first, closing=closing)
    text = _ModelText(tree)
    for k in range(len(tree.links)):
        obstacle = text.add(k)
        if obstacle is not None:
            return obstacle
    return text.source()


# Ways of a model that was written and read again.
_ARCHIVES = ("saveToString", "saveToXML", "saveToText", "saveToBinary", "StreamBuffer", "pickle")
READ_AGAIN = tuple(f"{name}:{how}" for name in copies.OF_MODELS for how in _ARCHIVES)
# Of these no joint moves by itself, as their data have it.
_MIMICS_LACK = (*READ_AGAIN, *(f"{name}:JointData" for name in objects.FROM_DATA), "jacobian_world:J")
_NAMED_FRAMES = "fs = [m.getFrameId(f'f{{k}}') for k in range({})]"


def _transformed(locked: list[str], appended: bool) -> list[str]:
    """Statements that make the model that is asked for: one appended to another, joints locked."""
    lines = ["m = pin.appendModel(m, m2, at, pin.SE3.Identity())"] if appended else []
    if locked:
        lines.append("q0 = pin.neutral(m)")
        lines += [f"q0[{place}] = {value}" for place, value in zip(locked[::2], locked[1::2], strict=True)]
        ids = ", ".join(place.removeprefix("m.joints[").removesuffix("].idx_q") for place in locked[::2])
        lines.append(f"m = pin.buildReducedModel(m, [{ids}], q0)")
    return lines
