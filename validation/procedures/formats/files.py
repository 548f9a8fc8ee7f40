"""One robot in the formats that hold it, written here by hand: what the readers make of each is the same mechanism."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib import util
from pathlib import Path
from typing import Any, cast

import numpy as np

import symofros as sf

from ...contract.quantities import ROUNDING
from ...mechanics.geometry import Array, skew
from ..scene import Cell, Scene, off

# Poses in links, in joints' frames and in frames of their own; an inertia that is turned; an axis along another frame;
# links welded before and behind joints; losses, limits, joints that mimic others; other units.
_FOLDER = Path(__file__).parents[2] / "corpus" / "readings"


def native() -> sf.System:
    """The same arm, stated by our nouns."""
    mast = sf.RigidBody(
        "mast", sf.Joint("m", "fixed", position=(0.1, 0.2, 0.5), rotation=sf.Rotation.rpy(0.3, -0.2, 0.4))
    )
    turn = np.array([[np.cos(0.5), 0.0, -np.sin(0.5)], [0.0, 1.0, 0.0], [np.sin(0.5), 0.0, np.cos(0.5)]])
    x, y, z = map(float, turn @ [0.0, 0.6, 0.8])  # Of the mast, along the joint's own axes.
    shoulder = sf.Joint(
        "shoulder", "revolute", "mast", position=(0.05, 0, 0), rotation=sf.Rotation.rpy(0, 0.5, 0), axis=(x, y, z)
    )
    upper = sf.Inertia(
        2.0, (0.2, 0.05, -0.03), (0.1, 0.2, 0.25, 0.01, -0.02, 0.005), rotation=sf.Rotation.rpy(0.3, 0.1, -0.2)
    )
    # The joint is placed in its child, and moves along an axis of its own frame there.
    elbow = sf.Joint(
        "elbow", "prismatic", "upper", position=(0.4, 0, 0.1), rotation=sf.Rotation.rpy(0, 0, 0.7), axis=(1.0, 0.0, 0.0)
    )
    weld = sf.Joint("weld", "fixed", "lower", position=(0.3, 0, 0), rotation=sf.Rotation.rpy(0, 0.4, 0))
    return sf.System(
        "arm",
        (
            mast,
            sf.RigidBody("upper", shoulder, upper),
            sf.RigidBody("lower", elbow, sf.Inertia(1.2, (0.1, -0.02, 0.04), (0.05, 0.06, 0.07))),
            sf.RigidBody("tool", weld, sf.Inertia(0.3, moments=(0.01, 0.02, 0.02))),
        ),
    )


_UPPER = sf.Inertia(2.0, (0.2, 0.05, -0.03), (0.1, 0.2, 0.25, 0.01, -0.02, 0.005))
_LOWER = sf.Inertia(1.2, (0.1, -0.02, 0.04), (0.05, 0.06, 0.07))
_TOOL = sf.Inertia(0.3, moments=(0.01, 0.02, 0.02))


def as_urdf() -> sf.System:
    """What the URDF states, with all losses and the joint that mimics."""
    foot = sf.Joint("foot", "fixed", position=(0.1, 0.2, 0.5), rotation=sf.Rotation.rpy(0.3, -0.2, 0.4))
    losses = (sf.Damper(0.4), sf.Friction(0.3, minimum_velocity=1e-3))
    shoulder = sf.Joint(
        "shoulder",
        "revolute",
        "base",
        position=(0.05, 0, 0),
        rotation=sf.Rotation.rpy(0, 0.5, 0),
        axis=(0, 0.6, 0.8),
        elements=losses,
        limits=sf.Limits(-1.0, 0.5, velocity=3.0, effort=7.0),
    )
    elbow = sf.Joint(
        "elbow",
        "prismatic",
        "upper",
        position=(0.4, 0, 0.1),
        rotation=sf.Rotation.rpy(0, 0, 0.7),
        axis=(1, 0, 0),
        elements=(sf.Damper(0.1),),
        limits=sf.Limits(-0.2, 0.3, velocity=2.0, effort=9.0),
    )
    grip = sf.Joint("grip", "continuous", "lower", position=(0.2, 0, 0), axis=(0, 1, 0))
    weld = sf.Joint("weld", "fixed", "lower", position=(0.3, 0, 0), rotation=sf.Rotation.rpy(0, 0.4, 0))
    return sf.System(
        "arm",
        (
            sf.RigidBody("base", foot),
            sf.RigidBody("upper", shoulder, replace(_UPPER, rotation=sf.Rotation.rpy(0.3, 0.1, -0.2))),
            sf.RigidBody("lower", elbow, _LOWER),
            sf.RigidBody("finger", grip, sf.Inertia(0.2, (0, 0, 0.1), (0.01, 0.01, 0.01))),
            sf.RigidBody("tool", weld, _TOOL),
        ),
        constraints=(sf.Coupling("mimic", sf.formula("grip + 2*elbow - 0.1")),),
    )


def as_mjcf() -> sf.System:
    """What the MJCF states, with all losses and the coupling."""
    rad = math.pi / 180
    turn = np.eye(3)
    for axis, angle in zip(
        np.eye(3), (20 * rad, -10 * rad, 30 * rad), strict=True
    ):  # Each about the axes turned so far or fixed.
        turn = turn_about(axis, angle) @ turn
    w, x, y, z = np.array([0.9, 0.1, -0.3, 0.2]) / math.sqrt(0.95)
    elements = (sf.Spring(5.0, rest=20 * rad), sf.Damper(0.4), sf.Friction(0.3, minimum_velocity=1e-3))
    shoulder = sf.Joint(
        "shoulder",
        "revolute",
        position=(0.1, 0.2, 0.5),
        rotation=sf.Rotation.matrix(turn.tolist()),
        axis=(0, 0.6, 0.8),
        elements=elements,
        armature=0.03,
        limits=sf.Limits(-60 * rad, 30 * rad),
    )
    elbow = sf.Joint(
        "elbow",
        "prismatic",
        "upper",
        position=(0.4, 0, 0.1),
        rotation=sf.Rotation.quaternion(x, y, z, w),
        axis=(1, 0, 0),
        elements=(sf.Damper(0.1),),
        limits=sf.Limits(-0.2, 0.3),
    )
    weld = sf.Joint("weld", "fixed", "lower", position=(0.3, 0, 0), rotation=sf.Rotation.rpy(0, 25 * rad, 0))
    bodies = (
        sf.RigidBody("upper", shoulder, _UPPER),
        sf.RigidBody("lower", elbow, _LOWER),
        sf.RigidBody("tool", weld, _TOOL),
    )
    coupling = sf.Coupling("joint", sf.formula("shoulder - 0.1 - 2*elbow"))
    return sf.System("arm", bodies, gravity=(0, 0.5, -9), constraints=(coupling,))


def as_usd() -> sf.System:
    """What the stage states, in its units of centimetres and degrees."""
    rad = math.pi / 180
    principal = sf.Rotation.quaternion(0.6, 0, 0, 0.8)
    upper = sf.Inertia(2.0, (0.2, 0.05, -0.03), (0.1, 0.2, 0.25), rotation=principal)
    shoulder = sf.Joint(
        "shoulder", "revolute", position=(0.1, 0.2, 0.5), axis=(0, 1, 0), limits=sf.Limits(-60 * rad, 30 * rad)
    )
    elbow = sf.Joint("elbow", "prismatic", "upper", position=(0.4, 0, 0.1), axis=(1, 0, 0), limits=sf.Limits(-0.2, 0.3))
    return sf.System("robot", (sf.RigidBody("upper", shoulder, upper), sf.RigidBody("lower", elbow, _LOWER)))


def turn_about(axis: Array, angle: float) -> Array:
    """The matrix that turns by an angle."""
    K = skew(axis)
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K)


@dataclass(frozen=True)
class Reading:
    """A file, how it is read, and the same by our nouns.

    Attributes:
        file: Name of the file.
        options: Of `load`.
        stated: The same by our nouns.
        frame: Link whose pose is compared.
        stops: Whether its limits become stops.
        noted: Words that the notes have.
        needs: Module without which the format is not read.
    """

    file: str
    options: dict[str, Any]
    stated: Callable[[], sf.System]
    frame: str
    stops: bool = False
    noted: tuple[str, ...] = ()
    needs: str = ""


_ALL = {"dissipation": "all"}
READINGS = {
    "SDF": Reading("arm.sdf", {}, native, "tool"),
    "URDF, losses and mimicry": Reading("arm.urdf", _ALL | {"mimic": True}, as_urdf, "tool", noted=("transmission",)),
    "URDF, stops": Reading(
        "arm.urdf",
        {"limits": "stops", "mimic": True, "dissipation": "viscous"},
        lambda: _kept(as_urdf(), sf.Damper),
        "tool",
        True,
    ),
    "URDF, nothing lost": Reading("arm.urdf", {"mimic": True}, lambda: _kept(as_urdf()), "tool"),
    "MJCF, losses": Reading("arm.xml", _ALL, as_mjcf, "tool", needs="mujoco"),
    "MJCF, viscous": Reading(
        "arm.xml", {"dissipation": "viscous"}, lambda: _kept(as_mjcf(), sf.Damper, sf.Spring), "tool", needs="mujoco"
    ),
    "USD": Reading("arm.usda", {}, as_usd, "lower", needs="pxr"),
    "USD, stops": Reading("arm.usda", {"limits": "stops"}, as_usd, "lower", True, needs="pxr"),
    "xacro": Reading("arm.xacro", {"mimic": True, "arguments": {"mass": "2"}}, lambda: _kept(as_urdf()), "tool"),
}


def _kept(system: sf.System, *kinds: type) -> sf.System:
    """The system with elements of some kinds alone."""
    bodies: list[Any] = []
    for body in system.bodies:
        assert body.joint is not None
        elements = tuple(one for one in body.joint.elements if isinstance(one, kinds))
        bodies.append(replace(body, joint=replace(body.joint, elements=elements)))
    return replace(system, bodies=tuple(bodies))


def read(_: Scene) -> Iterator[Cell]:
    """What the readers make of files: inertia, weight, forces, conditions, limits, places, and what they note."""
    for what, reading in READINGS.items():
        if reading.needs and util.find_spec(reading.needs) is None:
            yield Cell(f"an arm read from {what}", 0.0, ROUNDING, absent=f"pip install {reading.needs}")
            continue
        system = sf.load(_FOLDER / reading.file, **reading.options)
        yield Cell(f"an arm read from {what}", _misread(reading, system), _READ)
    yield from _included()


_READ = 3e-12  # Rotations by degrees and by rounded quaternions.


def _misread(reading: Reading, system: sf.System) -> float:
    """Largest error of what a reader made of a file."""
    names = ("mass_matrix", "bias", "generalized_force", "frame_pose", "constraint", "constraint_jacobian")
    functions = sf.Options(names, (reading.frame,), backend="interpreter")
    stated = reading.stated()
    if reading.stops:
        stated = _with_stops(stated)
    theirs, ours = sf.compile(system, functions), sf.compile(stated, functions)
    if theirs.names.q != ours.names.q:
        return math.inf
    wrong = float(any(word not in " ".join(system.notes) for word in reading.noted))
    found = np.array(sorted(("qv".index(one.of), *one[1:]) for one in theirs.record.joint_limits if one.of in "qv"))
    worst = wrong + off(found.reshape(-1, 4), _limits(stated, theirs.names.q))
    rng = np.random.default_rng(12)
    for _k in range(5):
        q, v = rng.uniform(-1.0, 1.0, (2, theirs.nv))
        pairs = [
            (m.mass_matrix(q), m.bias(q, v), m.generalized_force(q, v, np.zeros(m.nu)), *m.frame_pose(reading.frame, q))
            + ((np.abs(m.constraint(q)), np.abs(m.constraint_jacobian(q))) if m.nc else ())
            for m in (theirs, ours)
        ]
        worst = max(worst, *(off(one, other) for one, other in zip(*pairs, strict=True)))
    return worst


def _limits(stated: sf.System, names: Sequence[str]) -> Array:
    """Limits that no stop keeps: 0 of a coordinate or 1 of a speed, its number, least and greatest value."""
    rows = []
    for joint in (body.joint for body in stated.bodies if body.joint is not None and body.joint.limits is not None):
        limits, k = joint.limits, names.index(joint.name)
        assert limits is not None
        if limits.lower is not None and not any(isinstance(one, sf.Stop) for one in joint.elements):
            rows.append((0.0, k, limits.lower, limits.upper))
        if limits.velocity:
            rows.append((1.0, k, -limits.velocity, limits.velocity))
    return np.array(sorted(rows)).reshape(-1, 4)


def _with_stops(system: sf.System) -> sf.System:
    """A model with a stop at each limit, critically damped at 20 ms with the inertia that the joint alone meets."""
    model = sf.compile(replace(system, constraints=()), sf.Options(("mass_matrix",), backend="interpreter"))
    inertias = 1.0 / np.diag(np.linalg.inv(model.mass_matrix(model.neutral())))
    rate = 2.0 * math.pi / 0.02
    bodies = []
    for body in system.bodies:
        joint = body.joint
        if joint is not None and joint.limits is not None and joint.limits.lower is not None:
            inertia = float(inertias[model.names.q.index(joint.name)])
            stop = sf.Stop(inertia * rate**2, 2.0 * inertia * rate, joint.limits.lower, joint.limits.upper)
            body = replace(cast(Any, body), joint=replace(joint, elements=(*joint.elements, stop)))
        bodies.append(body)
    return replace(system, bodies=tuple(bodies))


def _included() -> Iterator[Cell]:
    """Models that others include: placed, named, merged; meshes apart, a file in parts is the file whole."""
    outer = """<sdf version="1.11"><model name="outer"><include{}><uri>model://arm</uri>{}</include></model></sdf>"""
    for what, attributes, inside, prefix, moved in (
        ("nested", "", "", "arm::", False),
        ("merged", ' merge="true"', "", "", False),
        ("named and placed", "", "<name>left</name><pose>0.3 -0.2 0.1 0 0 0.6</pose>", "left::", True),
    ):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (
                ("arm", _FOLDER.joinpath("arm.sdf").read_text(encoding="utf-8")),
                ("outer", outer.format(attributes, inside)),
            ):
                Path(folder, name).mkdir()
                Path(folder, name, "model.sdf").write_text(text, encoding="utf-8")
            system = sf.load(Path(folder, "outer", "model.sdf"))
        functions = sf.Options(("mass_matrix", "bias", "frame_pose"), backend="interpreter")
        theirs, ours = sf.compile(system, functions), sf.compile(native(), functions)
        q, v = np.random.default_rng(12).uniform(-1.0, 1.0, (2, 2))
        worst = float(theirs.names.q != tuple(prefix + name for name in ours.names.q))
        p, R = ours.frame_pose("tool", q)
        turn = turn_about(np.array([0.0, 0.0, 1.0]), 0.6 * moved)
        p, R = turn @ p + np.array([0.3, -0.2, 0.1]) * moved, turn @ R
        at, turned = theirs.frame_pose(f"{prefix}tool", q)
        pairs = [
            (theirs.mass_matrix(q), ours.mass_matrix(q)),
            (theirs.bias(q, v), ours.bias(q, v)),
            (at, p),
            (turned, R),
        ]
        yield Cell(f"a model included in SDF, {what}", max(worst, *(off(one, other) for one, other in pairs)), _READ)
