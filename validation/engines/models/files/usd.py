"""USD: UsdPhysics of rigid bodies on joints (openusd.org, UsdPhysics)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from ...interface import Joint, Tree, vector
from . import readers
from .readers import LIMITED, NEXT, Reading, about, along, hung

_of = partial(readers.reading, "usd")
_UNTURNED = "(1, 0, 0, 0)"


_HEAD = 'metersPerUnit = 1\n    kilogramsPerUnit = 1\n    upAxis = "Z"'
_DOWN = "vector3f physics:gravityDirection = (0, 0, -1)\n    float physics:gravityMagnitude = 9.81"
_TURNS_ABOUT_Y = 'uniform token physics:axis = "Y"'
_MASS, _COM, _MOMENTS = "float physics:mass = 1", "(0, 0.125, 0.25)", "(0.25, 0.375, 0.5)"
# Density of colliders that state none [kg/m^3].
_WATER = 1000.0


def _inertial(com: str = _COM, moments: str = _MOMENTS, axes: str = _UNTURNED, mass: str = _MASS) -> str:
    return f"""{mass}
        point3f physics:centerOfMass = {com}
        float3 physics:diagonalInertia = {moments}
        quatf physics:principalAxes = {axes}"""


def file(
    axis: str = _TURNS_ABOUT_Y,
    inertial: str = _inertial(),
    at: str = "(0, 0, 0.5)",
    head: str = _HEAD,
    scene: str = _DOWN,
    joint: str = "Revolute",
) -> str:
    """A body on a joint in the world: the joint's axis and limits, the body's mass or shapes, where it stands."""
    return f"""#usda 1.0
(
    defaultPrim = "m"
    {head}
)
def PhysicsScene "scene" {{
    {scene}
}}
def Xform "m" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {{
    def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {{
        double3 xformOp:translate = {at}
        uniform token[] xformOpOrder = ["xformOp:translate"]
        {inertial}
    }}
    def Physics{joint}Joint "joint" {{
        rel physics:body1 = </m/b>
        point3f physics:localPos0 = {at}
        {axis}
    }}
}}
"""


def shape(kind: str, sizes: str, more: str = "", api: str = "") -> str:
    """A collider at (0, 0.125, 0.25) of the body."""
    return f"""def {kind} "s" (prepend apiSchemas = ["PhysicsCollisionAPI"{api}]) {{
            {sizes}
            double3 xformOp:translate = {_COM}
            uniform token[] xformOpOrder = ["xformOp:translate"]
            {more}
        }}"""


def _stage() -> Iterator[tuple[str, Reading]]:
    """Units and axes of the stage, gravity by default."""
    inertia = readers.diagonal(0.25, 0.375, 0.5)
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25), inertia=inertia)
    in_centimetres = _inertial("(0, 12.5, 25)", "(2500, 3750, 5000)")
    scene = "vector3f physics:gravityDirection = (0, 0, -1)\n    float physics:gravityMagnitude = 981"
    centimetres = file(inertial=in_centimetres, at="(0, 0, 50)", head=_HEAD.replace("= 1", "= 0.01", 1), scene=scene)
    yield _of("centimetres", centimetres, body)
    by_default = 'kilogramsPerUnit = 1\n    upAxis = "Z"'
    yield _of("metres left out", file(inertial=in_centimetres, at="(0, 0, 50)", head=by_default, scene=scene), body)
    yield _of("kilograms left out", file(head='metersPerUnit = 1\n    upAxis = "Z"'), body)
    in_grams = _inertial(moments="(250, 375, 500)", mass="float physics:mass = 1000")
    yield _of(
        "grams", file(inertial=in_grams, head=_HEAD.replace("PerUnit = 1\n    up", "PerUnit = 0.001\n    up")), body
    )
    yield _of("gravity left out", file(scene=""), body)
    aside = "vector3f physics:gravityDirection = (0.6, 0, -0.8)\n    float physics:gravityMagnitude = 2.5"
    for name, scene, head, gravity in (
        ("oblique gravity", aside, _HEAD, (1.5, 0.0, -2.0)),
        ("up along Y, gravity left out", "", _HEAD.replace('"Z"', '"Y"'), (0.0, -9.81, 0.0)),
        ("up axis and gravity left out", "", _HEAD.replace('\n    upAxis = "Z"', ""), (0.0, -9.81, 0.0)),
        ("up along Y, gravity along Z", _DOWN, _HEAD.replace('"Z"', '"Y"'), (0.0, 0.0, -9.81)),
    ):
        title = f"usd: {name}"
        yield title, Reading("usd", file(scene=scene, head=head), Tree(title, (body,), gravity=gravity))


def _masses() -> Iterator[tuple[str, Reading]]:
    """Mass and moments that follow from colliders, their densities and sizes."""
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25))
    cube, ball = shape("Cube", "double size = 0.5"), shape("Sphere", "double radius = 0.25")
    side, sphere = 0.5**3, 4.0 / 3.0 * math.pi * 0.25**3

    def of(name: str, inertial: str, mass: float, moment: float) -> tuple[str, Reading]:
        solid = replace(body, mass=mass, inertia=readers.diagonal(*[moment] * 3))
        return _of(name, file(inertial=inertial), solid)

    yield of("cube by default", cube, _WATER * side, _WATER * side * 0.5**2 / 6.0)
    yield of("ball by default", ball, _WATER * sphere, _WATER * sphere * 0.4 * 0.25**2)
    dense = "float physics:density = 500\n        "
    yield of("cube of the body's density", dense + cube, 500.0 * side, 500.0 * side * 0.5**2 / 6.0)
    own = shape("Cube", "double size = 0.5", "float physics:density = 250", ', "PhysicsMassAPI"')
    yield of("cube of its own density", own, 250.0 * side, 250.0 * side * 0.5**2 / 6.0)
    yield of("cube's density before the body's", dense + own, 250.0 * side, 250.0 * side * 0.5**2 / 6.0)
    yield of("cube of the body's mass", f"float physics:mass = 3\n        {cube}", 3.0, 3.0 * 0.5**2 / 6.0)
    heavy = shape("Cube", "double size = 0.5", "float physics:mass = 3", ', "PhysicsMassAPI"')
    yield of("cube of its own mass", heavy, 3.0, 3.0 * 0.5**2 / 6.0)


def _joints() -> Iterator[tuple[str, Reading]]:
    """Limits, in degrees and in units of length."""
    inertia = readers.diagonal(0.25, 0.375, 0.5)
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25), inertia=inertia)
    bounds = f"{_TURNS_ABOUT_Y}\n        float physics:lowerLimit = -30\n        float physics:upperLimit = 75"
    turned = hung(body, limits=tuple(map(math.radians, (-30.0, 75.0))))
    yield _of("limits of a hinge", file(axis=bounds), turned, asked=LIMITED)
    sliding = bounds.replace("-30", "-0.25").replace("75", "2")
    slid = hung(body, kind="prismatic", limits=(-0.25, 2.0))
    yield _of("limits of a slide", file(axis=sliding, joint="Prismatic"), slid, asked=LIMITED)
    yield _of("slide", file(joint="Prismatic"), hung(body, kind="prismatic"))


def _drives() -> Iterator[tuple[str, Reading]]:
    """Drives, of angles for degrees; the greatest force."""
    inertia = readers.diagonal(0.25, 0.375, 0.5)
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25), inertia=inertia)
    degree, asked = math.degrees(1.0), ("joint_drives", "joint_force_limits")
    for kind, joint, unit in (("angular", "Revolute", degree), ("linear", "Prismatic", 1.0)):
        numbers = {"stiffness": 2.0, "damping": 0.25, "targetPosition": 0.5, "maxForce": 8.0}
        drive = "".join(f"\n        float drive:{kind}:physics:{name} = {one}" for name, one in numbers.items())
        text = file(axis=_TURNS_ABOUT_Y + drive, joint=joint).replace(
            f'Physics{joint}Joint "joint"',
            f'Physics{joint}Joint "joint" (prepend apiSchemas = ["PhysicsDriveAPI:{kind}"])',
        )
        own = hung(body, drive=(2.0 * unit, 0.25 * unit, 0.5 / unit), bounds=(0.0, 8.0))
        if joint == "Prismatic":
            own = hung(own, kind="prismatic")
        yield _of(f"drive, {kind}", text, own, asked=asked)


def _frames() -> Iterator[tuple[str, Reading]]:
    """Frames of joints on both bodies, turned and moved; bodies that are scaled."""
    inertia = readers.diagonal(0.25, 0.375, 0.5)
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25), inertia=inertia)
    (hinge,) = body.joints
    turn, quarter = about((1.0, 0.0, 0.0), math.acos(0.28) * 2.0), "(0.28, 0.96, 0, 0)"
    both = f"quatf physics:localRot0 = {quarter}\n        quatf physics:localRot1 = {quarter}"
    along_it = vector(np.array(turn)[:, 1])
    yield _of("joint turned on both bodies", file(axis=f"{_TURNS_ABOUT_Y}\n        {both}"), hung(body, axis=along_it))
    first = f"{_TURNS_ABOUT_Y}\n        quatf physics:localRot0 = {quarter}"
    turned = replace(body, joints=(replace(hinge, R=turn),))
    placed = file(axis=first).replace(
        'uniform token[] xformOpOrder = ["xformOp:translate"]',
        f"quatd xformOp:orient = {quarter}\n        "
        'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]',
        1,
    )
    yield _of("joint turned on the first body", placed, turned)
    apart = f"{_TURNS_ABOUT_Y}\n        point3f physics:localPos1 = (0.25, -0.5, 0.125)"
    back = Joint("fixed", p=(-0.25, 0.5, -0.125))
    aside = replace(body, joints=(replace(hinge, p=(0.25, -0.5, 0.625)), back))
    moved = file(axis=apart).replace(
        "point3f physics:localPos0 = (0, 0, 0.5)", "point3f physics:localPos0 = (0.25, -0.5, 0.625)"
    )
    yield _of("joint beside its body's origin", moved, aside)


def _collisions() -> Iterator[tuple[str, Reading]]:
    """Which colliders have mass: those that are enabled; a mass of zero is none."""
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25))
    moment = 3.0 * 0.5**2 / 6.0
    solid = replace(body, mass=3.0, inertia=readers.diagonal(*[moment] * 3))
    api = ', "PhysicsMassAPI"'
    on = shape("Cube", "double size = 0.5", "float physics:mass = 3", api)
    off = shape(
        "Cube", "double size = 0.25", "bool physics:collisionEnabled = 0\n            float physics:mass = 4", api
    )
    yield _of("collider disabled beside another", file(inertial=on + "\n        " + off.replace('"s"', '"t"')), solid)
    side = 0.5**3
    cube = replace(body, mass=_WATER * side, inertia=readers.diagonal(*[_WATER * side * 0.5**2 / 6.0] * 3))
    plain = shape("Cube", "double size = 0.5")
    # Without MassAPI of the body's own, its mass is the sum of its colliders'.
    bare = file(inertial=off.replace('"s"', '"t"') + "\n        " + on).replace(', "PhysicsMassAPI"]) {', "]) {", 1)
    yield _of("collider disabled on a body without MassAPI", bare, solid)
    yield _of("mass of zero", file(inertial=f"float physics:mass = 0\n        {plain}"), cube)
    none = "float physics:mass = 0\n        float3 physics:diagonalInertia = (0, 0, 0)\n        "
    yield _of("mass and moments of zero", file(inertial=none + plain), cube)
    zero = shape("Cube", "double size = 0.5", "float physics:mass = 0", api)
    yield _of("collider of mass zero", file(inertial=zero), cube)
    scaled = plain.replace(
        'uniform token[] xformOpOrder = ["xformOp:translate"]',
        "double3 xformOp:scale = (2, 0.5, 1)\n            "
        'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]',
    )
    mass, x, y, z = _WATER * 1.0 * 0.25 * 0.5, 1.0, 0.25, 0.5
    moments = (mass * (y * y + z * z) / 12.0, mass * (x * x + z * z) / 12.0, mass * (x * x + y * y) / 12.0)
    box = replace(body, mass=mass, inertia=readers.diagonal(*moments))
    yield _of("collider scaled", file(inertial=scaled), box)
    radius, height = 0.25, 0.5
    volume = math.pi * radius**2 * height
    across, along_it = radius**2 / 4.0 + height**2 / 12.0, radius**2 / 2.0
    for letter, own in (("Z", (across, across, along_it)), ("X", (along_it, across, across))):
        sizes = f'double radius = 0.25\n            double height = 0.5\n            uniform token axis = "{letter}"'
        mass = _WATER * volume
        link = replace(body, mass=mass, inertia=readers.diagonal(*(mass * one for one in own)))
        yield _of(f"cylinder along {letter}", file(inertial=shape("Cylinder", sizes)), link)


def files() -> dict[str, Reading]:
    """All of them, by name; numbers that floats state exactly."""
    inertia = readers.diagonal(0.25, 0.375, 0.5)
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25), inertia=inertia)
    half = about((1.0, 0.0, 0.0), 1.5707963267948966)
    turned = replace(body, inertia=along(half, inertia))
    stated = (
        _of("plain", file(), body),
        _of("axis left out", file(axis=""), hung(body, axis=(1.0, 0.0, 0.0))),
        _of("principal axes turned", file(inertial=_inertial(axes="(0.70710678, 0.70710678, 0, 0)")), turned),
    )
    return dict([*stated, *_stage(), *_masses(), *_joints(), *_drives(), *_frames(), *_collisions()])
