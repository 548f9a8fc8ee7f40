"""Joints that files let follow others: the constant and the slope, each stated and each left out, of three formats."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ...interface import Constraint, End, Link, Tree
from .mjcf import FIRST, MA, MB, RADIAN, file
from .readers import NEXT, Reading, hung

_ASKED = ("coupled_coefficients",)


def _of(form: str, name: str, text: str, constant: float, slope: float, *links: Link) -> tuple[str, Reading]:
    """A file whose last link's joint follows that before it."""
    title = f"{form}: {name}"
    leader, follower = (End(link.name) for link in links[-2:])
    tied = Constraint("polynomial", (follower, leader), (constant, slope))
    return title, Reading(form, text, Tree(title, links, constraints=(tied,)), asked=_ASKED)


def _mjcf() -> Iterator[tuple[str, Reading]]:
    """An equality's polynomial, of which what is left out is 0 1 0 0 0, as it is by default classes, too."""
    a, b = '<joint name="a" axis="0 0 1"/>' + MA, '<joint name="b" axis="0 1 0"/>' + MB
    classes = '<default><default class="k"><equality solref="0.01 1"/></default></default>'
    rows = {
        "in full": ('polycoef="0.25 1.5 0 0 0"', "", 0.25, 1.5),
        "constant and slope": ('polycoef="0.25 1.5"', "", 0.25, 1.5),
        "slope left out": ('polycoef="0.25"', "", 0.25, 1.0),
        "polynomial left out": ("", "", 0.0, 1.0),
        "polynomial of a class, slope left out": ('class="k" polycoef="0.25"', classes, 0.25, 1.0),
        "slope of zero": ('polycoef="0.25 0"', "", 0.25, 0.0),
    }
    for name, (stated, head, constant, slope) in rows.items():
        element = f'<equality><joint joint1="b" joint2="a" {stated}/></equality>'
        text = file(a, b, RADIAN + head).replace("</mujoco>", f"{element}</mujoco>")
        yield _of("mjcf", f"equality of joints, {name}", text, constant, slope, FIRST, NEXT)


def _urdf() -> Iterator[tuple[str, Reading]]:
    """A mimic joint's multiplier, 1 where it is left out, and offset, 0 where it is."""
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    links = "".join(f'<link name="{name}">{inertial}</link>' for name in ("base", "a", "b"))
    joint = (
        '<joint name="{child}" type="revolute"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 1 0"/>'
        '<limit lower="-3" upper="3" effort="9" velocity="9"/>{more}</joint>'
    )
    for name, stated, constant, slope in (
        ("multiplier and offset", 'multiplier="1.5" offset="0.25"', 0.25, 1.5),
        ("multiplier left out", 'offset="0.25"', 0.25, 1.0),
        ("offset left out", 'multiplier="-1.5"', 0.0, -1.5),
        ("multiplier and offset left out", "", 0.0, 1.0),
    ):
        joints = joint.format(parent="base", child="a", more="")
        joints += joint.format(parent="a", child="b", more=f'<mimic joint="a" {stated}/>')
        text = f'<robot name="r">{links}{joints}</robot>'
        yield _of("urdf", f"coupled by mimic, {name}", text, constant, slope, hung(FIRST), NEXT)


_USD = """#usda 1.0
(
    defaultPrim = "m"
    metersPerUnit = 1
    kilogramsPerUnit = 1
    upAxis = "Z"
)
def Xform "m" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {{
    def Xform "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {{
        float physics:mass = 2
        float3 physics:diagonalInertia = (0.25, 0.375, 0.5)
    }}
    def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {{
        float physics:mass = 1
        float3 physics:diagonalInertia = (0.25, 0.375, 0.5)
    }}
    def PhysicsRevoluteJoint "first" {{
        rel physics:body1 = </m/a>
        uniform token physics:axis = "Z"
    }}
    def PhysicsRevoluteJoint "second" (prepend apiSchemas = [{schemas}]) {{
        rel physics:body0 = </m/a>
        rel physics:body1 = </m/b>
        uniform token physics:axis = "Y"
        rel newton:mimicJoint = </m/first>
        {stated}
    }}
}}
"""


def _usd() -> Iterator[tuple[str, Reading]]:
    """Newton's schema of mimic joints (newton-usd-schemas), alone and beside MuJoCo's schema of equalities."""
    schemas = {"coupled by mimic": '"NewtonMimicAPI"', "equality by mimic": '"MjcEqualityJointAPI", "NewtonMimicAPI"'}
    # Of a hinge the constant is in degrees.
    first, second, turn = "float newton:mimicCoef0 = 45", "float newton:mimicCoef1 = 1.5", math.pi / 4.0
    for way, names in schemas.items():
        for name, stated, constant, slope in (
            ("constant and slope", f"{first}\n        {second}", turn, 1.5),
            ("slope left out", first, turn, 1.0),
            ("constant left out", second, 0.0, 1.5),
        ):
            text = _USD.format(schemas=names, stated=stated)
            yield _of("usd", f"{way}, {name}", text, constant, slope, hung(FIRST), NEXT)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_mjcf(), *_urdf(), *_usd()])
