"""URDF: planes, shapes and sensors of links (wiki.ros.org/urdf/XML); what stands alone is in `covering.urdf_files`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...interface import ORIGIN, Array, End, Joint, Vector, rows
from . import readers
from .readers import (
    ASKEW,
    BODY,
    NEXT,
    PRODUCTS,
    TURNED,
    Reading,
    diagonal,
    hung,
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
    lost = replace(BODY, joints=(Joint("planar", R=first.R, p=first.p, damping=0.7),))
    damped = f'planar|{_AT}{_ALONG}<dynamics damping="0.7"/>'
    yield _of("damping of a planar joint", _chain(damped, _SECOND), lost, NEXT, asked=("joint_dampings",))


def _across(axis: Vector) -> Array:
    """A rotation whose third column is an axis."""
    z = np.array(axis)
    x = np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


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


def _unstated() -> Iterator[tuple[str, Reading]]:
    """A last link, fixed, with the mass that the schema of URDF has where the value is left out: zero."""
    none = _INERTIA.replace("0.2", "0").replace("0.3", "0").replace("0.4", "0")
    links = _A, f'<link name="b"><inertial><mass/>{none}</inertial></link>'
    stated = _chain(_FIRST.replace("revolute", "prismatic"), _FIXED, links=links)
    empty = replace(_REST, mass=0.0, com=ORIGIN, inertia=diagonal(0.0, 0.0, 0.0))
    yield _of("mass without value", stated, hung(BODY, kind="prismatic"), empty, asked=("link_bodies",))


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict(
        [
            *_planes(),
            *_from_shapes(),
            *_shaped(),
            *_sensed(),
            *_unstated(),
        ]
    )
