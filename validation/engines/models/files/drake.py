"""Files with elements of Drake's own: what its parsing page says of <drake:...> (multibody/parsing)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from ...interface import Joint, Link
from . import readers
from .readers import BODY, PASSIVE, PRINCIPAL, Reading, hung

URDF, SDF = "urdf of drake", "sdf of drake"
_INERTIA = '<inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/>'
_A = f'<link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/>{_INERTIA}</inertial></link>'
_B = f'<link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/>{_INERTIA}</inertial></link>'
_AT = '<origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/>'
_LIMIT = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'
_ENDS = '<parent link="{}"/><child link="{}"/>'
_HINGE = f'<joint name="joint_a" type="revolute">{_ENDS.format("world", "a")}{_AT}<axis xyz="0 0 1"/>{_LIMIT}</joint>'
_SECOND = Link("b", 0, (Joint("revolute", p=(0.0, 0.0, 0.5), axis=(0.0, 1.0, 0.0)),), 1.0, (0.0, 0.1, 0.2), PRINCIPAL)
_ON_A = (
    f'<joint name="joint_b" type="revolute">{_ENDS.format("a", "b")}'
    f'<origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>{_LIMIT}</joint>'
)
_of = partial(readers.reading, URDF)


def _file(*parts: str) -> str:
    return f'<robot name="r" xmlns:drake="http://drake.mit.edu"><link name="world"/>{"".join(parts)}</robot>'


def _kind(kind: str, more: str = "") -> str:
    """The first joint as one that URDF does not know."""
    return f'<drake:joint name="joint_a" type="{kind}">{_ENDS.format("world", "a")}{_AT}{more}</drake:joint>'


def _motor(joint: str, text: str) -> str:
    return (
        f'<transmission name="t_{joint}"><type>transmission_interface/SimpleTransmission</type><joint name="{joint}"/>'
        f'<actuator name="m_{joint}">{text}</actuator></transmission>'
    )


def _sdf(*parts: str) -> str:
    return f'<sdf version="1.9" xmlns:drake="http://drake.mit.edu"><model name="r">{"".join(parts)}</model></sdf>'


_MOMENTS = "<inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>"
# The links stand where their joints put them at zero.
_SDF_A = (
    '<link name="a"><pose>0.1 0.2 0.3 0.3 -0.4 0.5</pose>'
    f"<inertial><pose>0.1 -0.2 0.3 0 0 0</pose><mass>2</mass>{_MOMENTS}</inertial></link>"
)
_SDF_B = (
    '<link name="b"><pose relative_to="a">0 0 0.5 0 0 0</pose>'
    f"<inertial><pose>0 0.1 0.2 0 0 0</pose><mass>1</mass>{_MOMENTS}</inertial></link>"
)
_SDF_ON_A = (
    '<joint name="joint_b" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz>{}</axis>{}</joint>'
)
_SDF_HINGE = (
    '<joint name="joint_a" type="revolute"><parent>world</parent><child>a</child>'
    "<axis><xyz>0 0 1</xyz>{}</axis>{}</joint>"
)


def _first(kind: str, **changes: object) -> Link:
    return hung(BODY, kind=kind, **changes)


def _urdf() -> Iterator[tuple[str, Reading]]:
    """Joints, rotors, springs of URDF."""
    gear = '<drake:rotor_inertia value="0.25"/><drake:gear_ratio value="3"/>'
    yield _of(
        "rotor and gear", _file(_A, _B, _HINGE, _ON_A, _motor("joint_a", gear)), hung(BODY, armature=(2.25,)), _SECOND
    )
    second = hung(_SECOND, armature=(2.25,))
    yield _of("rotor and gear of the second joint", _file(_A, _B, _HINGE, _ON_A, _motor("joint_b", gear)), BODY, second)
    alone = '<drake:rotor_inertia value="0.25"/>'
    yield _of(
        "rotor without a gear",
        _file(_A, _B, _HINGE, _ON_A, _motor("joint_a", alone)),
        hung(BODY, armature=(0.25,)),
        _SECOND,
    )
    yield _of("ball joint", _file(_A, _B, _kind("ball"), _ON_A), _first("ball"), _SECOND)
    yield _of(
        "universal joint", _file(_A, _B, _kind("universal"), _ON_A), _first("universal", axis=(1.0, 0.0, 0.0)), _SECOND
    )
    across = '<axis xyz="0 0 1"/>'
    yield _of("planar joint", _file(_A, _B, _kind("planar", across), _ON_A), _first("planar"), _SECOND)
    thread = '<axis xyz="0.6 0 0.8"/><drake:screw_thread_pitch value="0.75"/>'
    screw = _first("helical", axis=(0.6, 0.0, 0.8), pitch=0.75 / (2.0 * math.pi))
    yield _of("screw joint", _file(_A, _B, _kind("screw", thread), _ON_A), screw, _SECOND)


def _of_sdf() -> Iterator[tuple[str, Reading]]:
    """The same of SDF."""
    of = partial(readers.reading, SDF)
    gear = "<drake:rotor_inertia>0.25</drake:rotor_inertia><drake:gear_ratio>3</drake:gear_ratio>"
    rest = _SDF_ON_A.format("", "")
    turning = _SDF_HINGE.format("<limit><effort>9</effort></limit>", gear)
    yield of("rotor and gear", _sdf(_SDF_A, _SDF_B, turning, rest), hung(BODY, armature=(2.25,)), _SECOND)
    lost = _SDF_HINGE.format("<dynamics><damping>0.75</damping></dynamics>", "")
    yield of("damping", _sdf(_SDF_A, _SDF_B, lost, rest), hung(BODY, damping=0.75), _SECOND, asked=("joint_dampings",))
    spring = "<dynamics><spring_stiffness>4</spring_stiffness><spring_reference>0.25</spring_reference></dynamics>"
    sprung = hung(BODY, stiffness=4.0, rest=0.25)
    yield of(
        "spring",
        _sdf(_SDF_A, _SDF_B, _SDF_HINGE.format(spring, ""), rest),
        sprung,
        _SECOND,
        asked=(*PASSIVE, "passive_forces"),
    )
    for kind in ("ball", "universal"):
        changes = {"axis": (1.0, 0.0, 0.0)} if kind == "universal" else {}
        joint = f'<joint name="joint_a" type="{kind}"><parent>world</parent><child>a</child>{{}}</joint>'
        both = "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>" if kind == "universal" else ""
        yield of(f"{kind} joint", _sdf(_SDF_A, _SDF_B, joint.format(both), rest), _first(kind, **changes), _SECOND)
    thread = "<axis><xyz>0.6 0 0.8</xyz></axis><screw_thread_pitch>0.75</screw_thread_pitch>"
    joint = f'<joint name="joint_a" type="screw"><parent>world</parent><child>a</child>{thread}</joint>'
    screw = _first("helical", axis=(0.6, 0.0, 0.8), pitch=0.75 / (2.0 * math.pi))
    yield of("screw joint", _sdf(_SDF_A, _SDF_B, joint, rest), screw, _SECOND)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_urdf(), *_of_sdf()])
