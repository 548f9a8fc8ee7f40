"""Files of robots with one entry changed, and what an engine's own reader makes of the change.

Whether a change shows is asked of Pinocchio (URDF) or MuJoCo (MJCF): frames, M and gravity forces of the changed file
against those of the original, at the same coordinates.
"""

from __future__ import annotations

import random
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from symofros.base.arrays import Array
from tests.late import late
from validation.inputs.cases import robot_file

pin, mujoco = late("pinocchio", "validation"), late("mujoco", "validation")

CREATURE = Path(__file__).parents[3] / "validation/corpus/creature.xml"
ROBOTS = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "go2": "go2_description/urdf/go2.urdf",
    "icub": "icub_description/robots/icub.urdf",
}
FLOATING = {"go2", "icub"}
INERTIA = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


@dataclass(frozen=True)
class Planted:
    """A changed file.

    Attributes:
        robot: Name of the robot.
        text: The file.
        kind: What was changed, such as "inertial origin xyz".
        subject: Name of the joint or link.
        entries: What the difference may be called.
    """

    robot: str
    text: str
    kind: str
    subject: str
    entries: tuple[str, ...]


@cache
def original(robot: str) -> str:
    path = CREATURE if robot == "creature" else robot_file(ROBOTS[robot])
    return path.read_text(encoding="utf-8")


def planted(robot: str, seed: int) -> Planted:
    """One change, of a kind that is drawn first, so that all kinds come alike."""
    rng = random.Random(f"{robot} {seed}")
    root = ET.fromstring(original(robot))
    kinds = MJCF_KINDS if robot == "creature" else URDF_KINDS
    while True:
        kind = rng.choice(sorted(kinds))
        change, entries = kinds[kind]
        found = change(root, rng)
        if found:
            return Planted(robot, ET.tostring(root, encoding="unicode"), kind, found, entries)


def _numbers(text: str) -> list[float]:
    return [float(x) for x in text.split()]


def _text(values: Iterator[float] | list[float]) -> str:
    return " ".join(repr(float(x)) for x in values)


def _shift(element: ET.Element, name: str, default: str, rng: random.Random, size: float) -> None:
    """Change one of the numbers of an attribute."""
    values = _numbers(element.get(name, default))
    values[rng.randrange(len(values))] += rng.choice((-1, 1)) * size * rng.uniform(0.5, 1.5)
    element.set(name, _text(values))


def _scale(element: ET.Element, name: str, rng: random.Random) -> None:
    value = float(element.get(name, "0"))
    element.set(name, repr(value * rng.uniform(1.05, 1.5) if value else rng.uniform(0.1, 1.0)))


def _links(root: ET.Element) -> list[ET.Element]:
    return [link for link in root.iter("link") if link.find("inertial/mass") is not None]


def _joints(root: ET.Element, moving: bool = False) -> list[ET.Element]:
    stated = [joint for joint in root.iter("joint") if joint.find("parent") is not None]
    return [joint for joint in stated if not moving or joint.get("type") != "fixed"]


def _inertial(path: str, name: str, size: float):  # type: ignore[no-untyped-def]
    def change(root: ET.Element, rng: random.Random) -> str:
        link = rng.choice(_links(root))
        inertial = link.find("inertial")
        assert inertial is not None
        element = inertial.find(path)
        if element is None:
            element = ET.SubElement(inertial, path)
        if path == "origin":
            _shift(element, name, "0 0 0", rng, size)
        elif path == "inertia":
            entry = rng.choice(INERTIA)
            moments = [float(element.get(k, "0")) for k in INERTIA[:3]]
            element.set(entry, repr(float(element.get(entry, "0")) + rng.uniform(0.05, 0.2) * max(moments)))
        else:
            _scale(element, name, rng)
        return str(link.get("name"))

    return change


def _placed(name: str, size: float, moving: bool):  # type: ignore[no-untyped-def]
    def change(root: ET.Element, rng: random.Random) -> str:
        joint = rng.choice([j for j in _joints(root) if (j.get("type") != "fixed") == moving] or _joints(root))
        origin = joint.find("origin")
        if origin is None:
            origin = ET.SubElement(joint, "origin")
        _shift(origin, name, "0 0 0", rng, size)
        return str(joint.get("name"))

    return change


def _axis(root: ET.Element, rng: random.Random) -> str:
    joint = rng.choice(_joints(root, moving=True))
    axis = joint.find("axis")
    if axis is None:
        axis = ET.SubElement(joint, "axis", xyz="1 0 0")
    _shift(axis, "xyz", "1 0 0", rng, 0.1)
    values = np.array(_numbers(axis.get("xyz", "")))
    axis.set("xyz", _text(list(values / np.linalg.norm(values))))
    return str(joint.get("name"))


def _flipped(root: ET.Element, rng: random.Random) -> str:
    joint = rng.choice(_joints(root, moving=True))
    axis = joint.find("axis")
    if axis is None:
        return ""
    axis.set("xyz", _text([-x for x in _numbers(axis.get("xyz", "1 0 0"))]))
    return str(joint.get("name"))


def _typed(root: ET.Element, rng: random.Random) -> str:
    joint = rng.choice(_joints(root, moving=True))
    if any(j.find("mimic") is not None for j in root.iter("joint")) and joint.get("type") == "prismatic":
        return ""
    others = {"revolute": ["prismatic", "fixed"], "continuous": ["fixed"], "prismatic": ["revolute", "fixed"]}
    joint.set("type", rng.choice(others[str(joint.get("type"))]))
    return str(joint.get("name"))


def _unlimited(root: ET.Element, rng: random.Random) -> str:
    joints = [j for j in _joints(root) if j.get("type") == "revolute"]
    joint = rng.choice(joints)
    joint.set("type", "continuous")
    return str(joint.get("name"))


def _limit(root: ET.Element, rng: random.Random) -> str:
    joint = rng.choice([j for j in _joints(root, moving=True) if j.find("limit") is not None])
    limit = joint.find("limit")
    assert limit is not None
    name = rng.choice(["lower", "upper", "effort", "velocity"])
    limit.set(name, repr(float(limit.get(name, "0")) + (0.1 if name != "lower" else -0.1)))
    return str(joint.get("name"))


def _dissipation(root: ET.Element, rng: random.Random) -> str:
    joint = rng.choice(_joints(root, moving=True))
    dynamics = joint.find("dynamics")
    if dynamics is None:
        dynamics = ET.SubElement(joint, "dynamics")
    _scale(dynamics, rng.choice(["damping", "friction"]), rng)
    return str(joint.get("name"))


def _visual(root: ET.Element, rng: random.Random) -> str:
    shapes = [shape for shape in root.iter() if shape.tag in ("visual", "collision")]
    shape = rng.choice(shapes)
    origin = shape.find("origin")
    if origin is None:
        origin = ET.SubElement(shape, "origin")
    _shift(origin, "xyz", "0 0 0", rng, 0.05)
    return "-"


def _reordered(root: ET.Element, rng: random.Random) -> str:
    children = list(root)
    rng.shuffle(children)
    root[:] = children
    return "-"


def _renamed(root: ET.Element, rng: random.Random) -> str:
    links = {str(link.get("name")): f"body_{k}" for k, link in enumerate(root.iter("link"))}
    for element in root.iter():
        for key in ("name", "link"):
            if element.tag in ("link", "parent", "child") and element.get(key) in links:
                element.set(key, links[str(element.get(key))])
    return "-"


URDF_KINDS = {
    "mass": (_inertial("mass", "value", 0.0), ("mass",)),
    "centre of mass": (_inertial("origin", "xyz", 0.02), ("center of mass",)),
    "inertial rpy": (_inertial("origin", "rpy", 0.2), ("inertia",)),
    "inertia": (_inertial("inertia", "", 0.0), ("inertia",)),
    "origin xyz": (_placed("xyz", 0.02, True), ("origin", "zero of the coordinate")),
    "origin rpy": (_placed("rpy", 0.1, True), ("origin", "zero of the coordinate")),
    "fixed origin": (_placed("xyz", 0.02, False), ("origin",)),
    "fixed rpy": (_placed("rpy", 0.1, False), ("origin",)),
    "axis": (_axis, ("axis",)),
    "axis reversed": (_flipped, ("sign of the coordinate",)),
    "joint type": (_typed, ("joint kind",)),
    "continuous": (_unlimited, ("lower limit", "upper limit")),
    "limit": (_limit, ("lower limit", "upper limit", "limit of effort", "limit of velocity")),
    "dissipation": (_dissipation, ("damping", "friction")),
    "visual": (_visual, ()),
    "order": (_reordered, ()),
    "names of links": (_renamed, ()),
}


def _mjcf(tag: str, name: str, default: str, size: float):  # type: ignore[no-untyped-def]
    def change(root: ET.Element, rng: random.Random) -> str:
        world = root.find("worldbody")
        assert world is not None
        owners = [(body, x) for body in world.iter("body") for x in ([body] if tag == "body" else body.findall(tag))]
        owners = [(body, x) for body, x in owners if name in x.attrib or (default and x.get("name") != "float")]
        if not owners:
            return ""
        body, element = rng.choice(owners)
        # Where a free body starts is its state, and balls have no axis.
        if body.find("freejoint") is not None and tag == "body" or name == "axis" and element.get("type") == "ball":
            return ""
        if size:
            _shift(element, name, default, rng, size)
        else:
            _scale(element, name, rng)
        return str(element.get("name") if tag == "joint" else body.get("name"))

    return change


MJCF_KINDS = {
    "armature": (_mjcf("joint", "armature", "", 0.0), ("armature",)),
    "joint axis": (_mjcf("joint", "axis", "", 0.2), ("axis",)),
    "joint pos": (_mjcf("joint", "pos", "", 0.02), ("origin",)),
    "body pos": (_mjcf("body", "pos", "", 0.05), ("origin", "zero of the coordinate")),
    "stiffness": (_mjcf("joint", "stiffness", "", 0.0), ("stiffness",)),
    "inertial mass": (_mjcf("inertial", "mass", "", 0.0), ("mass",)),
    "inertial pos": (_mjcf("inertial", "pos", "", 0.02), ("center of mass",)),
    "fullinertia": (_mjcf("inertial", "fullinertia", "", 0.004), ("inertia",)),
    "geom mass": (_mjcf("geom", "mass", "", 0.0), ("mass",)),
    "geom pos": (_mjcf("geom", "pos", "", 0.02), ("center of mass", "zero of the coordinates")),
}


def shows(case: Planted) -> bool:
    """Whether an engine sees the change: in frames, M or gravity forces."""
    values = _in_mujoco if case.robot == "creature" else _in_pinocchio
    before, after = values(original(case.robot), case.robot), values(case.text, case.robot)
    if before.shape != after.shape:
        return True
    return bool(np.abs(before - after).max() > 1e-9 * (1.0 + np.abs(before).max()))


def _in_pinocchio(text: str, robot: str) -> Array:
    root = (pin.JointModelFreeFlyer(),) if robot in FLOATING else ()
    model = pin.buildModelFromXML(text, *root)
    data, rng = model.createData(), np.random.default_rng(1)
    # By names: another order in the file is no change. Names of links are not compared.
    names = sorted(model.names[1:])
    places = [(model.joints[model.getJointId(name)], float(rng.uniform(-1, 1))) for name in names]
    q = pin.neutral(model)
    for joint, value in places:
        if joint.nq == 1:
            q[joint.idx_q] = value
        elif joint.nv == 1:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
    v = np.concatenate([np.arange(joint.idx_v, joint.idx_v + joint.nv) for joint, _ in places])
    M = np.array(pin.crba(model, data, q))
    g = np.array(pin.computeGeneralizedGravity(model, data, q))
    pin.framesForwardKinematics(model, data, q)
    kinds = (pin.FrameType.BODY, pin.FrameType.JOINT, pin.FrameType.FIXED_JOINT)
    joints = {f.name: data.oMf[k] for k, f in enumerate(model.frames) if f.type in kinds[1:]}
    poses = [np.r_[joints[name].translation, joints[name].rotation.ravel()] for name in sorted(joints)]
    return np.concatenate([M[np.ix_(v, v)].ravel(), g[v], *poses])


def _in_mujoco(text: str, robot: str) -> Array:
    model = mujoco.MjModel.from_xml_string(text)
    data, rng = mujoco.MjData(model), np.random.default_rng(1)
    model.dof_damping[:] = 0.0
    mujoco.mj_integratePos(model, data.qpos, rng.uniform(-1, 1, model.nv), 1.0)
    mujoco.mj_forward(model, data)
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    return np.concatenate([M.ravel(), data.qfrc_bias, data.xpos.ravel(), data.xmat.ravel()])
