"""URDF: what its elements mean, where they are left out, and what has no effect (wiki.ros.org/urdf/XML)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...interface import ORIGIN, Array, End, Joint, Link, Vector, rows
from . import readers
from .readers import (
    ASKEW,
    BODY,
    BOUNDED,
    IDENTITY,
    LOSSES,
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

_INERTIA = '<inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/>'
_OBLONG = '<inertia ixx="{}" iyy="{}" izz="{}" ixy="{}" ixz="{}" iyz="{}"/>'.format(*PRODUCTS)
_EQUAL = _INERTIA.replace("0.2", "0.3").replace("0.4", "0.3")
_A = f'<link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/>{_INERTIA}</inertial></link>'
_B = f'<link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/>{_INERTIA}</inertial></link>'
_C = _B.replace('"b"', '"c"')
_ASKEW_A = _A.replace('xyz="0.1 -0.2 0.3"', 'xyz="0.1 -0.2 0.3" rpy="0.5 0.6 0.7"')
_ASKEW_TWO = tuple(one.replace("/><mass", ' rpy="0.5 0.6 0.7"/><mass') for one in (_A, _B))
_SHAPED = (
    '<geometry><box size="0.4 0.6 1.2"/></geometry>',
    '<geometry><cylinder radius="0.2" length="0.7"/></geometry>',
    '<geometry><sphere radius="0.25"/></geometry>',
)
_LIMIT = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'
_AT = '<origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/>'
_FIRST = f'revolute|{_AT}<axis xyz="0 0 1"/>{_LIMIT}'
_ALONG, _OBLIQUE = '<axis xyz="0 0 1"/>', '<axis xyz="0.6 0 0.8"/>'
_SECOND = f'revolute|<origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>{_LIMIT}'
_FIXED = 'fixed|<origin xyz="0 0 0.5"/>'
_WORLD = '<link name="world"/>'
_BOX = '<geometry><box size="0.4 0.6 1.2"/></geometry>'
_PIN = '<geometry><cylinder radius="0.2" length="0.7"/></geometry>'
_SHAPES = (
    f'<visual><origin xyz="1 2 3"/>{_BOX}<material name="red"><color rgba="1 0 0 1"/></material></visual>'
    f'<visual>{_PIN}</visual><collision name="shape"><origin xyz="0.1 -0.2 0.3" rpy="0.1 0.2 0.3"/>{_BOX}</collision>'
    f"<collision>{_PIN}</collision>"
)
# The fixed links of files of three.
_C_LINK = replace(NEXT, name="c", parent=1)
_REST = hung(NEXT, kind="fixed")


def _joint(name: str, parent: str, stated: str, named: str = "joint_{}") -> str:
    kind, _, rest = stated.partition("|")
    ends = f'<parent link="{parent}"/><child link="{name}"/>'
    return f'<joint name="{named.format(name)}" type="{kind}">{ends}{rest}</joint>'


def _chain(*stated: str, links: tuple[str, ...] = (_A, _B, _C), more: str = "") -> str:
    """A file of links in series, with each one's joint: its kind and what it states."""
    parents = ("world", "a", "b")
    joints = [_joint("abc"[k], parents[k], one) for k, one in enumerate(stated)]
    return f'<robot name="r">{_WORLD}{"".join(links[: len(stated)])}{"".join(joints)}{more}</robot>'


_of = partial(readers.reading, "urdf")


def _inertias() -> Iterator[tuple[str, Reading]]:
    """What links state of inertia."""

    def stated(name: str, a: str, link: Link) -> tuple[str, Reading]:
        return _of(name, _chain(_FIRST, _SECOND, links=(a, _B)), link, NEXT)

    turned = replace(BODY, inertia=along(ASKEW, PRINCIPAL))
    yield stated("plain", _A, BODY)
    yield stated("inertial frame turned", _ASKEW_A, turned)
    equal = replace(BODY, inertia=diagonal(0.3, 0.3, 0.3))
    yield stated("equal moments, frame turned", _ASKEW_A.replace(_INERTIA, _EQUAL), equal)
    two = _ASKEW_A.replace('ixx="0.2"', 'ixx="0.3"')
    yield stated("two equal moments, frame turned", two, replace(BODY, inertia=along(ASKEW, diagonal(0.3, 0.3, 0.4))))
    yield stated("products of inertia", _A.replace(_INERTIA, _OBLONG), replace(BODY, inertia=OBLONG))
    askew = replace(BODY, inertia=along(ASKEW, OBLONG))
    yield stated("products of inertia, frame turned", _ASKEW_A.replace(_INERTIA, _OBLONG), askew)
    yield stated("inertial origin left out", _A.replace('<origin xyz="0.1 -0.2 0.3"/>', ""), replace(BODY, com=ORIGIN))
    unplaced = _ASKEW_A.replace('xyz="0.1 -0.2 0.3" ', "")
    yield stated("inertial frame turned, xyz left out", unplaced, replace(turned, com=ORIGIN))
    yield stated("shapes beside inertia", _A.replace("</link>", f"{_SHAPES}</link>"), BODY)
    reversed_text = _A.replace('<origin xyz="0.1 -0.2 0.3"/><mass value="2"/>', '<mass value="2"/>').replace(
        "</inertial>", '<origin xyz="0.1 -0.2 0.3"/></inertial>'
    )
    yield stated("elements in another order", reversed_text, BODY)


def _placements() -> Iterator[tuple[str, Reading]]:
    """Where joints stand, and about what they turn."""

    def first(name: str, origin: str, **changes: object) -> tuple[str, Reading]:
        return _of(name, _chain(_FIRST.replace(_AT, origin), _SECOND), hung(BODY, **changes), NEXT)

    def axis(name: str, text: str, value: tuple[float, float, float]) -> tuple[str, Reading]:
        return _of(name, _chain(_FIRST, _SECOND.replace('<axis xyz="0 1 0"/>', text)), BODY, hung(NEXT, axis=value))

    yield first("rpy left out", '<origin xyz="0.1 0.2 0.3"/>', R=IDENTITY)
    yield first("xyz left out", '<origin rpy="0.3 -0.4 0.5"/>', p=ORIGIN)
    yield first("joint origin left out", "", R=IDENTITY, p=ORIGIN)
    for name, angles in (
        ("pitch of a quarter turn", (0.4, math.pi / 2, 0.3)),
        ("pitch of minus a quarter turn", (0.4, -math.pi / 2, 0.3)),
        ("roll of a half turn", (math.pi, 0.2, -0.3)),
        ("yaw of a half turn", (0.2, -0.3, math.pi)),
        ("angles beyond a half turn", (4.0, 2.5, -5.0)),
    ):
        text = " ".join(map(repr, angles))
        yield first(name, f'<origin xyz="0.1 0.2 0.3" rpy="{text}"/>', R=rpy_rotation(*angles))
    yield first("numbers in other spellings", '<origin xyz=" 1e-1 2.0E-1 +.3 " rpy="3e-1  -.4 +0.50"/>')
    yield axis("axis left out", "", (1.0, 0.0, 0.0))
    yield axis("axis against z", '<axis xyz="0 0 -1"/>', (0.0, 0.0, -1.0))
    yield axis("axis against x", '<axis xyz="-1 0 0"/>', (-1.0, 0.0, 0.0))
    yield axis("axis almost x", '<axis xyz="0.99999999995 0.00001 0"/>', (0.99999999995, 0.00001, 0.0))
    yield axis("axis of length 2", '<axis xyz="0 2 0"/>', (0.0, 1.0, 0.0))
    yield axis("axis oblique", _OBLIQUE, (0.6, 0.0, 0.8))


def _kinds() -> Iterator[tuple[str, Reading]]:
    """Kinds of joints, and what has no effect on the motion that they leave."""

    def second(name: str, text: str, **changes: object) -> tuple[str, Reading]:
        return _of(name, _chain(_FIRST, text), BODY, hung(NEXT, **changes))

    yield second("continuous", _SECOND.replace("revolute", "continuous"), form="unbounded")
    aside = {"axis": (0.6, 0.0, 0.8)}
    turns = _FIRST.replace("revolute", "continuous").replace(_ALONG, _OBLIQUE)
    yield _of("continuous, oblique", _chain(turns, _SECOND), hung(BODY, form="unbounded", **aside), NEXT)
    yield second("prismatic", _SECOND.replace("revolute", "prismatic"), kind="prismatic")
    slides = _FIRST.replace("revolute", "prismatic").replace(_ALONG, _OBLIQUE)
    yield _of("prismatic, oblique", _chain(slides, _SECOND), hung(BODY, kind="prismatic", **aside), NEXT)
    along_x = _SECOND.replace("revolute", "prismatic").replace('<axis xyz="0 1 0"/>', "")
    yield second("prismatic, axis left out", along_x, kind="prismatic", axis=(1.0, 0.0, 0.0))
    ratio = '<mimic joint="joint_a" multiplier="2" offset="0.5"/>'
    sliding = _SECOND.replace("revolute", "prismatic") + '<mimic joint="joint_a" multiplier="-0.25" offset="0.125"/>'
    yield second("mimic of a slide", sliding, kind="prismatic", mimics="a", ratio=-0.25, offset=0.125)
    turning = _SECOND.replace('<axis xyz="0 1 0"/>', _OBLIQUE) + '<mimic joint="joint_a" multiplier="-1.5"/>'
    yield second("mimic, oblique, offset left out", turning, axis=(0.6, 0.0, 0.8), mimics="a", ratio=-1.5)
    shifted = f'{_SECOND}<mimic joint="joint_a" offset="-0.75"/>'
    yield second("mimic, multiplier left out", shifted, mimics="a", offset=-0.75)
    last = replace(_C_LINK, joints=(replace(NEXT.joints[0], mimics="a", ratio=2.0, offset=0.5),))
    yield _of("mimic beyond a joint", _chain(_FIRST, _SECOND, _SECOND + ratio), BODY, NEXT, last)
    reversed_text = _SECOND.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>') + ratio
    yield second("mimic against an axis", reversed_text, axis=(0.0, -1.0, 0.0), mimics="a", ratio=2.0, offset=0.5)
    yield second("mimic", f"{_SECOND}{ratio}", mimics="a", ratio=2.0, offset=0.5)
    yield second("mimic with its defaults", f'{_SECOND}<mimic joint="joint_a"/>', mimics="a")
    yield second("limits that leave out zero", _SECOND.replace('lower="-9"', 'lower="0.5"').replace('"9"', '"1"', 1))
    damped = f'{_SECOND}<dynamics damping="0.7" friction="0.3"/>'
    yield _of("damping and friction", _chain(_FIRST, damped), BODY, NEXT, asked=PASSIVE)
    yield second("safety controller", f'{_SECOND}<safety_controller k_velocity="3"/><calibration rising="0.4"/>')
    loose = replace(BODY, joints=(Joint("free"),))
    yield _of("floating", _chain("floating|", _SECOND), loose, NEXT)
    plane = Joint("planar", R=BODY.joints[0].R, p=BODY.joints[0].p)
    yield _of("planar", _chain(f'planar|{_AT}<axis xyz="0 0 1"/>', _SECOND), replace(BODY, joints=(plane,)), NEXT)


def _planes() -> Iterator[tuple[str, Reading]]:
    """Planes across other axes than z: which two directions slide in them, the format leaves open."""
    first = BODY.joints[0]
    for name, text, axis in (
        ("planar about x", "1 0 0", (1.0, 0.0, 0.0)),
        ("planar about y", "0 1 0", (0.0, 1.0, 0.0)),
        ("planar against z", "0 0 -1", (0.0, 0.0, -1.0)),
        ("planar, oblique", "0.6 0 0.8", (0.6, 0.0, 0.8)),
    ):
        R = _across(axis)
        plane = Joint("planar", R=rows(np.array(first.R) @ R), p=first.p)
        turned = replace(BODY, joints=(plane, Joint("fixed", R=rows(R.T))))
        stated = f'planar|{_AT}<axis xyz="{text}"/>'
        yield _of(name, _chain(stated, _SECOND), turned, NEXT, asked=("sizes", "link_turning"))


def _across(axis: Vector) -> Array:
    """A rotation whose third column is an axis."""
    z = np.array(axis)
    x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _losses() -> Iterator[tuple[str, Reading]]:
    """Dampers and dry friction of joints, which no function of M and g shows."""
    text, lost = '<dynamics damping="0.7" friction="0.3"/>', {"damping": 0.7, "friction": 0.3}

    def second(name: str, text: str, **changes: object) -> tuple[str, Reading]:
        return _of(name, _chain(_FIRST, text), BODY, hung(NEXT, **changes), asked=LOSSES)

    yield second("losses of a hinge", _SECOND + text, **lost)
    yield second("losses of a hinge without limits", _SECOND.replace("revolute", "continuous") + text, **lost)
    yield second("losses of a slide", _SECOND.replace("revolute", "prismatic") + text, kind="prismatic", **lost)
    plane = replace(BODY, joints=(Joint("planar", R=BODY.joints[0].R, p=BODY.joints[0].p, damping=0.7),))
    damped = f'planar|{_AT}{_ALONG}<dynamics damping="0.7"/>'
    yield _of("damping of a planar joint", _chain(damped, _SECOND), plane, NEXT, asked=("joint_dampings",))
    yield second("friction alone", _SECOND + '<dynamics friction="0.3"/>', friction=0.3)
    yield second("damping alone", _SECOND + '<dynamics damping="0.7"/>', damping=0.7)


def _limits() -> Iterator[tuple[str, Reading]]:
    """Limits of joints; a bound that is left out is 0."""
    first = hung(BODY, limits=(-9.0, 9.0), bounds=(9.0, 9.0))

    def second(name: str, bounds: str, *limits: float, kind: str = "revolute") -> tuple[str, Reading]:
        text = _SECOND.replace(_LIMIT, f'<limit {bounds} effort="7" velocity="3"/>').replace("revolute", kind)
        return _of(
            name, _chain(_FIRST, text), first, hung(NEXT, kind=kind, limits=limits, bounds=(3.0, 7.0)), asked=BOUNDED
        )

    yield second("limits of a hinge", 'lower="-0.5" upper="1.25"', -0.5, 1.25)
    yield second("limits of a slide", 'lower="-0.25" upper="2"', -0.25, 2.0, kind="prismatic")
    yield second("limits above zero", 'lower="0.5" upper="1.25"', 0.5, 1.25)
    yield second("limits beyond a turn", 'lower="-7.5" upper="10"', -7.5, 10.0)
    yield second("lower limit left out", 'upper="1.25"', 0.0, 1.25)
    yield second("upper limit left out", 'lower="-0.5"', -0.5, 0.0)
    guard = '<safety_controller k_velocity="3" soft_lower_limit="-0.25" soft_upper_limit="0.5"/>'
    text = _SECOND.replace(_LIMIT, f'<limit lower="-0.5" upper="1.25" effort="7" velocity="3"/>{guard}')
    yield _of(
        "limits beside soft ones",
        _chain(_FIRST, text),
        first,
        hung(NEXT, limits=(-0.5, 1.25), bounds=(3.0, 7.0)),
        asked=BOUNDED,
    )


def _trees() -> Iterator[tuple[str, Reading]]:
    """Links that don't move, links without mass, names and order."""
    still = hung(BODY, kind="fixed")
    grounded = _chain(_FIRST.replace("revolute", "fixed"), _SECOND)
    yield _of("fixed link with mass first", grounded, still, NEXT)
    yield _of("fixed link with mass amid", _chain(_FIRST, _FIXED, _SECOND), BODY, _REST, _C_LINK)
    yield _of("fixed link with mass", _chain(_FIRST, _FIXED), BODY, _REST)
    empty = '<link name="b"/>'
    nothing = replace(_REST, mass=0.0, com=ORIGIN, inertia=diagonal(0.0, 0.0, 0.0))
    amid = _chain(_FIRST, _FIXED, _SECOND, links=(_A, empty, _C))
    yield _of("fixed link without inertia amid", amid, BODY, nothing, _C_LINK)
    yield _of("fixed link without inertia last", _chain(_FIRST, _FIXED, links=(_A, empty)), BODY, nothing)
    across = _SECOND.replace("0 1 0", "1 0 0")
    moving = replace(nothing, joints=(replace(NEXT.joints[0], axis=(1.0, 0.0, 0.0)),))
    crossed = _chain(_FIRST, across, _SECOND, links=(_A, empty, _C))
    yield _of("moving link without inertia amid", crossed, BODY, moving, _C_LINK)
    shaped = f'<link name="b">{_SHAPES}</link>'
    yield _of("shapes without inertia", _chain(_FIRST, _FIXED, links=(_A, shaped)), BODY, nothing)
    joints = _joint("b", "a", _SECOND) + _joint("a", "world", _FIRST)
    yield _of("children before parents", f'<robot name="r">{joints}{_B}{_A}{_WORLD}</robot>', BODY, NEXT)
    joints = _joint("a", "world", _FIRST, "{}") + _joint("b", "a", _SECOND, "{}")
    yield _of("joints named as their links", f'<robot name="r">{_WORLD}{_A}{_B}{joints}</robot>', BODY, NEXT)
    base = _chain(_FIRST, _SECOND).replace('"world"', '"ground"')
    yield _of("base link of another name", base, BODY, NEXT)
    heavy = _chain(_FIRST, _SECOND).replace(_WORLD, _B.replace('"b"', '"world"'))
    yield _of("base link with mass", heavy, BODY, NEXT)
    others = (
        '<gazebo reference="a"><mass>7</mass><gravity>0</gravity></gazebo>'
        '<material name="red"><color rgba="1 0 0 1"/></material>'
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="joint_a">'
        "<hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>"
        '<actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission><!-- end -->'
    )
    yield _of("elements of other programs", _chain(_FIRST, _SECOND, more=others), BODY, NEXT)


def _from_shapes() -> Iterator[tuple[str, Reading]]:
    """Inertias that a reader works out of the mass and the collision's shape, which stands at the mass centre."""
    centred = {_A: "0.1 -0.2 0.3", _B: "0 0.1 0.2"}
    boxes = {one: f'<collision><origin xyz="{at}"/>{_BOX}</collision></link>' for one, at in centred.items()}
    stated = _chain(_FIRST, _SECOND, links=tuple(one.replace("</link>", box) for one, box in boxes.items()))
    # Of a box of 0.4 by 0.6 by 1.2 and of one kilogram.
    moments = tuple((u * u + w * w) / 12.0 for u, w in ((0.6, 1.2), (0.4, 1.2), (0.4, 0.6)))
    of_box = [replace(link, inertia=diagonal(*(link.mass * one for one in moments))) for link in (BODY, NEXT)]
    yield readers.reading("urdf from shapes", "box", stated, *of_box)


def _shaped() -> Iterator[tuple[str, Reading]]:
    """Where the shapes of links stand, along which axes."""
    frames = End("a", ASKEW, (0.25, -0.5, 0.125)), End("b", rows(np.eye(3)), (0.0, 0.5, -0.25)), End("b", TURNED)
    placed = (
        '<origin xyz="0.25 -0.5 0.125" rpy="0.5 0.6 0.7"/>',
        '<origin xyz="0 0.5 -0.25"/>',
        '<origin rpy="0.3 -0.4 0.5"/>',
    )
    for name, a, b in (("shapes", _A, _B), ("shapes of links with turned inertia", *_ASKEW_TWO)):
        one, two, three = (f"<collision>{at}{shape}</collision>" for at, shape in zip(placed, _SHAPED, strict=True))
        stated = a.replace("</link>", f"{one}</link>"), b.replace("</link>", f"{two}{three}</link>")
        title, read = _of(name, _chain(_FIRST, _SECOND, links=stated), BODY, NEXT, asked=("shape_poses",))
        yield title, replace(read, tree=replace(read.tree, sensors=frames))


def _sensed() -> Iterator[tuple[str, Reading]]:
    """Sensors on links and joints, by iDynTree's elements: frames, if they are wanted."""
    frames = End("a", ASKEW, (0.25, -0.5, 0.125)), End("b", TURNED, (0.0, 0.5, -0.25))
    stated = _chain(
        _FIRST,
        _SECOND,
        more='<sensor name="o0" type="accelerometer"><parent link="a"/>'
        '<origin xyz="0.25 -0.5 0.125" rpy="0.5 0.6 0.7"/></sensor>'
        '<sensor name="o1" type="gyroscope"><parent link="b"/><origin xyz="0 0.5 -0.25" rpy="0.3 -0.4 0.5"/></sensor>'
        '<sensor name="o2" type="force_torque"><parent joint="joint_b"/><force_torque><frame>child</frame>'
        "<measure_direction>child_to_parent</measure_direction></force_torque></sensor>",
    )
    for form, asked in (("urdf", ("frames_beside_links",)), ("urdf with frames of sensors", ("frame_poses",))):
        title, read = readers.reading(form, "sensors", stated, BODY, NEXT, asked=asked)
        yield title, replace(read, tree=replace(read.tree, sensors=frames))


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict(
        [
            *_inertias(),
            *_placements(),
            *_kinds(),
            *_planes(),
            *_losses(),
            *_limits(),
            *_trees(),
            *_from_shapes(),
            *_shaped(),
            *_sensed(),
        ]
    )
