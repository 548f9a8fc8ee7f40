"""USD: what attributes of UsdPhysics mean, alone and with another (openusd.org, UsdGeom and UsdPhysics)."""

from __future__ import annotations

import math
import re
from functools import cache

import numpy as np

from ...interface import IDENTITY, Array, Joint, Link, Rows, Tree, Vector, rows, vector
from ..files.readers import Reading, about, along, diagonal
from .edits import Feature, Features, with_features
from .pairs import Pair

_BODY = """    def Xform "{name}" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {{
        double3 xformOp:translate = (0, 0, {height})
        uniform token[] xformOpOrder = ["xformOp:translate"]
        float physics:mass = {mass}
        point3f physics:centerOfMass = {com}
        float3 physics:diagonalInertia = (0.25, 0.375, 0.5)
        quatf physics:principalAxes = (1, 0, 0, 0)
    }}
"""
_JOINT = """    def PhysicsRevoluteJoint "{name}" {{
        {first}rel physics:body1 = </m/{body}>
        point3f physics:localPos0 = (0, 0, 0.5)
        uniform token physics:axis = "{axis}"
    }}
"""
_A, _B = (
    _BODY.format(name="a", height=0.5, mass=2, com="(0.25, -0.125, 0.5)"),
    _BODY.format(name="b", height=1, mass=1, com="(0, 0.125, 0.25)"),
)
_JA = _JOINT.format(name="ja", first="", body="a", axis="Z")
_JB = _JOINT.format(name="jb", first="rel physics:body0 = </m/a>\n        ", body="b", axis="Y")
_METRES, _KILOGRAMS, _UP = "    metersPerUnit = 1\n", "    kilogramsPerUnit = 1\n", '    upAxis = "Z"\n'
_DIRECTION = "    vector3f physics:gravityDirection = (0, 0, -1)\n"
_MAGNITUDE = "    float physics:gravityMagnitude = 9.81\n"
_ABOVE = 'def Xform "m" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {\n'
_PLAIN = (
    f'#usda 1.0\n(\n    defaultPrim = "m"\n{_METRES}{_KILOGRAMS}{_UP})\n'
    f'def PhysicsScene "scene" {{\n{_DIRECTION}{_MAGNITUDE}}}\n{_ABOVE}{_A}{_B}{_JA}{_JB}}}\n'
)


def _numbers(text: str, name: str, default: str) -> list[float]:
    found = re.search(rf"\b{re.escape(name)} = \(?([^()\n]+)\)?", text)
    return [float(one) for one in (found.group(1) if found else default).split(",")]


def _number(text: str, name: str, default: float) -> float:
    return _numbers(text, name, repr(default))[0]


def _token(text: str, name: str, default: str) -> str:
    found = re.search(rf'\b{re.escape(name)} = "(\w+)"', text)
    return found.group(1) if found else default


def _rotation(text: str, name: str) -> Rows:
    """Rotation of a quaternion, real part first."""
    w, *axis = _numbers(text, name, "1, 0, 0, 0")
    length = math.hypot(*axis)
    return about(vector(np.array(axis)), 2.0 * math.atan2(length, w)) if length else IDENTITY


def _prims(text: str, kind: str) -> dict[str, str]:
    """Prims of a kind by name, each with its attributes: an inner prim's lines stand deeper."""
    found = re.findall(rf'^    def ({kind}) "(\w+)"([^\n]*\n(?:        [^\n]*\n)*)', text, re.MULTILINE)
    return {name: f"{one}{inside}" for one, name, inside in found}


def _pose(text: str, side: int, metres: float, scale: Vector) -> tuple[Rows, Vector]:
    p: Array = np.array(_numbers(text, f"physics:localPos{side}", "0, 0, 0")) * scale * metres
    return _rotation(text, f"physics:localRot{side}"), vector(p)


def _joints(text: str, metres: float, above: Vector) -> tuple[Joint, ...]:
    """The joint's frame on the first body, the joint, the second body in its frame there; angles are in degrees."""
    is_on_world = "physics:body0" not in text
    R0, p0 = _pose(text, 0, metres, (1.0, 1.0, 1.0) if is_on_world else above)
    R1, p1 = _pose(text, 1, metres, above)
    back: Array = np.array(R1).T
    kind = text.partition("Joint")[0].removeprefix("Physics")
    place, after = Joint("fixed", R0, p0), Joint("fixed", rows(back), vector(-back @ p1))
    if kind == "Fixed":
        return place, after
    if kind == "Spherical":
        return place, Joint("ball"), after
    unit = math.radians(1.0) if kind == "Revolute" else metres
    bounds = [_number(text, f"physics:{one}Limit", inf) for one, inf in (("lower", -math.inf), ("upper", math.inf))]
    axis = np.eye(3)["XYZ".index(_token(text, "physics:axis", "X"))]
    made = Joint(
        "revolute" if kind == "Revolute" else "prismatic",
        axis=vector(axis),
        # Not limited in a direction: infinite (UsdPhysics), and zero where it is asked for (`joint_limits_of_some`).
        limits=tuple(unit * one if math.isfinite(one) else 0.0 for one in bounds)
        if any(map(math.isfinite, bounds))
        else (),
    )
    return place, made, after


def meaning(text: str) -> Tree:
    """The tree that a file states; what is left out counts as UsdGeom and UsdPhysics say.

    These are centimetres, kilograms, up along Y, and earth's gravity downwards.
    """
    metres, kilograms = _number(text, "metersPerUnit", 0.01), _number(text, "kilogramsPerUnit", 1.0)
    up: Array = np.eye(3)["XYZ".index(_token(text, "upAxis", "Y"))]
    down = np.array(_numbers(text, "physics:gravityDirection", "0, 0, 0"))
    magnitude = _number(text, "physics:gravityMagnitude", -math.inf)
    gravity = (9.81 if magnitude < 0.0 else magnitude * metres) * (down / np.linalg.norm(down) if down.any() else -up)
    scale = vector(np.array(_numbers(text.partition("    def Xform")[0], "xformOp:scale", "1, 1, 1")))
    bodies, links = _prims(text, "Xform"), []
    joints = _prims(text, r"Physics\w+Joint")
    for place, name in enumerate(bodies):
        stated = bodies[name]
        (joint,) = (one for one in joints.values() if f"physics:body1 = </m/{name}>" in one)
        moments = kilograms * metres**2 * np.array(_numbers(stated, "physics:diagonalInertia", "0, 0, 0"))
        com = metres * np.array(scale) * _numbers(stated, "physics:centerOfMass", "0, 0, 0")
        links.append(
            Link(
                name,
                place - 1,
                _joints(joint, metres, scale),
                kilograms * _number(stated, "physics:mass", 0.0),
                vector(com),
                along(_rotation(stated, "physics:principalAxes"), diagonal(*moments.tolist())),
            )
        )
    return Tree("", tuple(links), vector(gravity))


def edited(text: str, edits: Feature) -> str:
    """A file after edits: of each line or prim that is named, what stands in its place.

    Raises:
        LookupError: There is no such line.
    """
    for there, instead in edits:
        if there not in text:
            raise LookupError(f"no {there}")
        text = text.replace(there, str(instead), 1)
    return text


def _in_b(line: str) -> tuple[str, str]:
    """A line more in the second joint."""
    return ("        rel physics:body0 = </m/a>\n", f"        rel physics:body0 = </m/a>\n        {line}\n")


_MOMENTS = "        float3 physics:diagonalInertia = (0.25, 0.375, 0.5)\n"
_AXES = "        quatf physics:principalAxes = (1, 0, 0, 0)\n"
_TURN, _OTHER = "(0.28, 0.96, 0, 0)", "(0.5, 0.5, -0.5, 0.5)"
_OF_A, _OF_B = 'token physics:axis = "Z"', 'token physics:axis = "Y"'
_ON_B = 'def PhysicsRevoluteJoint "jb"'
FEATURES: Features = {
    "metres": {
        "centimetres": [(_METRES, _METRES.replace("1", "0.01"))],
        "metres left out": [(_METRES, "")],
    },
    "kilograms": {
        "kilograms left out": [(_KILOGRAMS, "")],
        "grams": [(_KILOGRAMS, _KILOGRAMS.replace("1", "0.001"))],
    },
    "up": {"up along Y": [(_UP, _UP.replace("Z", "Y"))], "up axis left out": [(_UP, "")]},
    "gravity": {
        "gravity left out": [(_DIRECTION + _MAGNITUDE, "")],
        "direction of gravity left out": [(_DIRECTION, "")],
        "oblique gravity": [(_DIRECTION, _DIRECTION.replace("(0, 0, -1)", "(0.6, 0, -0.8)"))],
        "direction of gravity of length 2": [(_DIRECTION, _DIRECTION.replace("-1", "-2"))],
        "magnitude of gravity left out": [(_MAGNITUDE, "")],
        "no gravity": [(_MAGNITUDE, _MAGNITUDE.replace("9.81", "0"))],
    },
    "inertia": {
        "principal axes turned": [(_AXES, _AXES.replace("(1, 0, 0, 0)", _TURN))],
        "mass centre at the origin": [("(0.25, -0.125, 0.5)", "(0, 0, 0)")],
    },
    "axis": {"axis left out": [(f"        uniform {_OF_B}\n", "")], "axis along Z": [(_OF_B, _OF_B.replace("Y", "Z"))]},
    "first axis": {"first axis along X": [(_OF_A, _OF_A.replace("Z", "X"))]},
    "kind": {
        "slide": [(_ON_B, _ON_B.replace("Revolute", "Prismatic"))],
        "ball": [(_ON_B, _ON_B.replace("Revolute", "Spherical"))],
        "fixed": [(_ON_B, _ON_B.replace("Revolute", "Fixed"))],
    },
    "limits": {
        "limits": [_in_b("float physics:lowerLimit = -30\n        float physics:upperLimit = 75")],
        "one limit of two": [_in_b("float physics:upperLimit = 75")],
    },
    "frames": {
        "turned on the first body": [_in_b(f"quatf physics:localRot0 = {_TURN}")],
        "turned on the second body": [_in_b(f"quatf physics:localRot1 = {_TURN}")],
        "turned on both bodies": [
            _in_b(f"quatf physics:localRot0 = {_TURN}\n        quatf physics:localRot1 = {_OTHER}")
        ],
        "beside the second body": [_in_b("point3f physics:localPos1 = (0.25, -0.5, 0.125)")],
        "beside and turned on the second body": [
            _in_b(f"point3f physics:localPos1 = (0.25, -0.5, 0.125)\n        quatf physics:localRot1 = {_OTHER}"),
        ],
    },
}
# What has no meaning: limits of what they are none of; axes of what has none.
NEVER: tuple[Pair, ...] = tuple(
    frozenset(pair)
    for pair in (
        *((one, factor) for one in ("ball", "fixed") for factor in ("limits", "axis")),
        ("ball", "frames"),
    )
)


@cache
def files() -> dict[str, Reading]:
    """All of them, by name; numbers that floats state exactly."""
    return with_features("usd", _PLAIN, FEATURES, meaning, 40, NEVER, edited)
