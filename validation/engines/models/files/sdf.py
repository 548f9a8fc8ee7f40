"""SDFormat: poses and axes in the frames that they are stated in, and what counts where they are left out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...interface import IDENTITY, ORIGIN, Array, Joint, Rows, Vector, rows, vector
from ...plugins.writing.urdf import numbers, rpy
from . import readers
from .readers import (
    ASKEW,
    BODY,
    LIMITED,
    NEXT,
    OBLONG,
    PASSIVE,
    PRINCIPAL,
    PRODUCTS,
    TURNED,
    Reading,
    along,
    diagonal,
    hung,
    rpy_rotation,
)

_LIMIT = "<limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit>"
_NAMES = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_AT_A = "0.1 0.2 0.3 0.3 -0.4 0.5"
_AXIS_A, _AXIS_B = "<xyz>0 0 1</xyz>", "<xyz>0 1 0</xyz>"
_of = partial(readers.reading, "sdf")


def _inertial(mass: str, pose: str, moments: tuple[float, ...] = (0.2, 0.3, 0.4, 0.0, 0.0, 0.0)) -> str:
    entries = "".join(f"<{name}>{value}</{name}>" for name, value in zip(_NAMES, moments, strict=True))
    return f"<inertial><pose>{pose}</pose><mass>{mass}</mass><inertia>{entries}</inertia></inertial>"


_IA, _IB = _inertial("2", "0.1 -0.2 0.3 0 0 0"), _inertial("1", "0 0.1 0.2 0 0 0")


def _link(name: str, pose: str, inertial: str) -> str:
    """A link; its pose as numbers, or as an element."""
    return f'<link name="{name}">{pose if "<" in pose else f"<pose>{pose}</pose>"}{inertial}</link>'


def _joint(name: str, parent: str, axis: str, kind: str = "revolute", more: str = "") -> str:
    """A joint; its axes as what <axis> holds, or as elements."""
    stated = axis if axis.startswith("<axis") or not axis else f"<axis>{axis}{_LIMIT}</axis>"
    child = name.rpartition("::")[2]
    ends = f"{more}<parent>{parent}</parent><child>{name}</child>"
    return f'<joint name="j{child}" type="{kind}">{ends}{stated}</joint>'


def _model(*elements: str, version: str = "1.6", pose: str = "") -> str:
    return f'<sdf version="{version}"><model name="m">{pose}{"".join(elements)}</model></sdf>'


_A = _link("a", _AT_A, _IA)
_JA = _joint("a", "world", _AXIS_A)


def _in_model(p: Vector) -> str:
    """The pose in the model's frame of what is placed so in the first link's."""
    world = np.array(TURNED) @ np.array(p) + np.array(BODY.joints[0].p)
    return f"{numbers(vector(world))} {numbers(rpy(TURNED))}"


_AT_B = _in_model((0.0, 0.0, 0.5))
_B = _link("b", _AT_B, _IB)
_JB = _joint("b", "a", _AXIS_B)


def _links() -> Iterator[tuple[str, Reading]]:
    """What links state."""

    def first(name: str, inertial: str, **changes: object) -> tuple[str, Reading]:
        return _of(name, _model(_link("a", _AT_A, inertial), _JA), replace(BODY, **changes))  # type: ignore[arg-type]

    def placed(name: str, pose: str, version: str, R: Rows = TURNED) -> tuple[str, Reading]:
        return _of(name, _model(_link("a", pose, _IA), _JA, version=version), hung(BODY, R=R))

    yield first("plain", _IA)
    yield _of("two links", _model(_A, _B, _JA, _JB), BODY, NEXT)
    turned = "0.1 -0.2 0.3 0.5 0.6 0.7"
    yield first("inertial frame turned", _inertial("2", turned), inertia=along(ASKEW, PRINCIPAL))
    equal = _inertial("2", turned, (0.3, 0.3, 0.3, 0.0, 0.0, 0.0))
    yield first("equal moments, frame turned", equal, inertia=diagonal(0.3, 0.3, 0.3))
    yield first("products of inertia", _inertial("2", "0.1 -0.2 0.3 0 0 0", PRODUCTS), inertia=OBLONG)
    askew = _inertial("2", turned, PRODUCTS)
    yield first("products of inertia, frame turned", askew, inertia=along(ASKEW, OBLONG))
    yield first("inertial pose left out", _IA.replace("<pose>0.1 -0.2 0.3 0 0 0</pose>", ""), com=ORIGIN)
    unit = diagonal(1.0, 1.0, 1.0)
    mass_alone = "<inertial><pose>0.1 -0.2 0.3 0 0 0</pose><mass>2</mass></inertial>"
    yield first("moments left out", mass_alone, inertia=unit)
    yield first("inertial left out", "", mass=1.0, com=ORIGIN, inertia=unit)
    shape = "<geometry><box><size>0.2 0.4 0.6</size></box></geometry>"
    shapes = f'<visual name="v">{shape}</visual><collision name="c"><pose>1 2 3 0 0 0</pose>{shape}</collision>'
    yield first("shapes beside inertia", _IA + shapes)
    grades = '<pose degrees="true">0.1 0.2 0.3 30 -20 50</pose>'
    R = rpy_rotation(*(float(np.radians(one)) for one in (30.0, -20.0, 50.0)))
    yield placed("pose in degrees", grades, "1.9", R)
    quaternion = '<pose rotation_format="quat_xyzw">0.1 0.2 0.3 0.4 -0.4 0.8 0.2</pose>'
    about = readers.about((2.0, -2.0, 4.0), 2.0 * float(np.arccos(0.2)))
    yield placed("pose by a quaternion", quaternion, "1.9", about)
    for name, pitch in (("pitch of a quarter turn", np.pi / 2), ("pitch of minus a quarter turn", -np.pi / 2)):
        R = rpy_rotation(0.4, float(pitch), 0.3)
        yield placed(name, f"0.1 0.2 0.3 0.4 {float(pitch)!r} 0.3", "1.6", R)
    yield _of("pose left out", _model(_link("a", "<!-- -->", _IA), _JA), hung(BODY, R=IDENTITY, p=ORIGIN))


def _computed() -> Iterator[tuple[str, Reading]]:
    """Inertia that is to be computed of collisions, of their densities or the link's (of SDFormat 1.11 and later)."""
    box, pose = "<box><size>0.2 0.4 0.6</size></box>", "<pose>0.1 -0.2 0.3 0.5 0.6 0.7</pose>"
    ball = "<sphere><radius>0.2</radius></sphere>"
    cylinder = "<cylinder><radius>0.1</radius><length>0.6</length></cylinder>"

    def collision(name: str, shape: str, more: str = "") -> str:
        return f'<collision name="{name}">{pose}{more}<geometry>{shape}</geometry></collision>'

    def of(name: str, shapes: str, mass: float, moments: Vector, more: str = "") -> tuple[str, Reading]:
        """Moments are those of a kilogram."""
        text = f'<inertial auto="true">{more}</inertial>{shapes}'
        inertia = along(ASKEW, diagonal(*(mass * one for one in moments)))
        body = replace(BODY, mass=mass, inertia=inertia)
        return _of(f"inertia computed of {name}", _model(_link("a", _AT_A, text), _JA, version="1.11"), body)

    of_box = (0.52 / 12.0, 0.40 / 12.0, 0.20 / 12.0)
    own, whole = "<density>250</density>", "<density>500</density>"
    yield of("a box", collision("c", box), 48.0, of_box)
    yield of("a box of its own density", collision("c", box, own), 12.0, of_box)
    yield of("a box of the link's density", collision("c", box), 24.0, of_box, whole)
    yield of("a box of its own density before the link's", collision("c", box, own), 12.0, of_box, whole)
    yield of("a ball", collision("c", ball), 4000.0 / 3.0 * np.pi * 0.008, (0.016, 0.016, 0.016))
    across = 0.01 / 4.0 + 0.36 / 12.0
    yield of("a cylinder", collision("c", cylinder), 6.0 * np.pi, (across, across, 0.005))
    yield of("two boxes", collision("c", box) + collision("d", box, own), 60.0, of_box)


def _joints() -> Iterator[tuple[str, Reading]]:
    """What joints state."""

    def first(name: str, joint: str, *joints: Joint, version: str = "1.6") -> tuple[str, Reading]:
        return _of(name, _model(_A, joint, version=version), replace(BODY, joints=joints or BODY.joints))

    hinge = BODY.joints[0]
    sideways = replace(hinge, axis=vector(np.array(TURNED).T @ np.array([0.6, 0.0, 0.8])))
    place = Joint("fixed", R=TURNED, p=hinge.p)
    yield first("axis of length 2", _joint("a", "world", "<xyz>0 0 2</xyz>"))
    oblique = replace(hinge, axis=(0.6, 0.0, 0.8))
    yield first("axis oblique", _joint("a", "world", "<xyz>0.6 0 0.8</xyz>"), oblique)
    model = '<xyz expressed_in="__model__">0.6 0 0.8</xyz>'
    yield first("axis along the model's", _joint("a", "world", model), sideways, version="1.9")
    parent = "<xyz>0.6 0 0.8</xyz><use_parent_model_frame>1</use_parent_model_frame>"
    yield first("axis along the parent model's", _joint("a", "world", parent), sideways)
    anchored = (place, Joint("revolute", p=(0.0, -0.1, 0.2), axis=hinge.axis), Joint("fixed", p=(0.0, 0.1, -0.2)))
    yield first("anchor of a joint", _joint("a", "world", _AXIS_A, more="<pose>0 -0.1 0.2 0 0 0</pose>"), *anchored)
    joint_turned = replace(hinge, axis=vector(np.array(ASKEW) @ np.array(hinge.axis)))
    yield first(
        "joint's frame turned", _joint("a", "world", _AXIS_A, more="<pose>0 0 0 0.5 0.6 0.7</pose>"), joint_turned
    )
    yield first("prismatic", _joint("a", "world", _AXIS_A, "prismatic"), replace(hinge, kind="prismatic"))
    yield first("ball", _joint("a", "world", "", "ball"), replace(hinge, kind="ball"))
    both = f"<axis><xyz>1 0 0</xyz>{_LIMIT}</axis><axis2><xyz>0 1 0</xyz>{_LIMIT}</axis2>"
    universal = replace(hinge, kind="universal", axis=(1.0, 0.0, 0.0), second=(0.0, 1.0, 0.0))
    yield first("universal", _joint("a", "world", both, "universal"), universal)
    yield first("continuous", _joint("a", "world", _AXIS_A, "continuous"), version="1.7")
    losses = f"<dynamics><damping>3</damping><friction>0.2</friction></dynamics>{_AXIS_A}"
    yield _of("damping and friction", _model(_A, _joint("a", "world", losses)), BODY, asked=PASSIVE)
    for kind in ("revolute", "prismatic"):
        bounds = _LIMIT.replace("-9", "-0.5").replace(">9</upper", ">1.25</upper")
        limited = hung(BODY, kind=kind, limits=(-0.5, 1.25))
        axis = f"<axis>{_AXIS_A}{bounds}</axis>"
        yield _of(f"limits of {kind}", _model(_A, _joint("a", "world", axis, kind)), limited, asked=LIMITED)
    still, rest = hung(BODY, kind="fixed"), hung(NEXT, kind="fixed")
    fixed_a, fixed_b = _joint("a", "world", "", "fixed"), _joint("b", "a", "", "fixed")
    yield _of("fixed link with mass first", _model(_A, _B, fixed_a, _JB), still, NEXT)
    yield _of("fixed link with mass", _model(_A, _B, _JA, fixed_b), BODY, rest)
    C = _link("c", _in_model((0.0, 0.0, 1.0)), _IB.replace('"b"', '"c"'))
    last = replace(NEXT, name="c", parent=1)
    amid = _model(_A, _B, C, _JA, fixed_b, _joint("c", "b", _AXIS_B))
    yield _of("fixed link with mass amid", amid, BODY, rest, last)
    yield _of("children before parents", _model(_JB, _JA, _B, _A), BODY, NEXT)


def _frames() -> Iterator[tuple[str, Reading]]:
    """Poses relative to what has a name (of SDFormat 1.7 and later)."""
    at = f"<pose>{_AT_A}</pose>"
    relative = _link("a", '<pose relative_to="ja"/>', _IA)
    hinge = _joint("a", "world", _AXIS_A, more=f'<pose relative_to="__model__">{_AT_A}</pose>')
    yield _of("pose relative to its joint", _model(relative, hinge, version="1.9"), BODY)
    near = _link("b", '<pose relative_to="a">0 0 0.5 0 0 0</pose>', _IB)
    yield _of("pose relative to a link", _model(_A, near, _JA, _JB, version="1.9"), BODY, NEXT)
    frame = '<frame name="f" attached_to="a"><pose>0 0.3 0 0.5 0.6 0.7</pose></frame>'
    # The second link stands at the frame.
    there = hung(NEXT, R=ASKEW, p=(0.0, 0.3, 0.0))
    framed = _link("b", '<pose relative_to="f"/>', _IB)
    yield _of("pose relative to a frame", _model(_A, frame, framed, _JA, _JB, version="1.9"), BODY, there)
    expressed = _joint("b", "a", '<xyz expressed_in="f">0 1 0</xyz>')
    turned = hung(NEXT, axis=vector(np.array(ASKEW) @ np.array([0.0, 1.0, 0.0])))
    yield _of("axis along a frame's", _model(_A, frame, near, _JA, expressed, version="1.9"), BODY, turned)
    by_frame = _joint("b", "f", _AXIS_B)
    yield _of("a frame for parent", _model(_A, frame, near, _JA, by_frame, version="1.9"), BODY, NEXT)
    R: Array = np.array(rpy_rotation(0.2, -0.3, 0.4))
    p = np.array([1.0, 2.0, 3.0]) + R @ np.array([0.1, 0.2, 0.3])
    moved = replace(BODY.joints[0], R=rows(R @ np.array(TURNED)), p=vector(p))
    placed = _model(_A, _JA, version="1.9", pose="<pose>1 2 3 0.2 -0.3 0.4</pose>")
    yield _of("pose of the model", placed, replace(BODY, joints=(moved,)))
    inner = f'<model name="n"><pose relative_to="a">0 0 0.5 0 0 0</pose>{_link("b", "<!-- -->", _IB)}</model>'
    nested = _model(_A, inner, _JA, _joint("n::b", "a", _AXIS_B), version="1.9")
    yield _of("model within the model", nested, BODY, NEXT)
    chosen = _model(_A, _JA, version="1.9", pose=at).replace('<model name="m">', '<model name="m" placement_frame="a">')
    yield _of("placement frame", chosen, BODY)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_links(), *_computed(), *_joints(), *_frames()])
