"""USD stages as text, for tests of the reader."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

_HEAD = """#usda 1.0
(
    defaultPrim = "robot"
    metersPerUnit = {meters!r}
    kilogramsPerUnit = {kilograms!r}
    upAxis = "{up}"
)
"""


ARM: dict[str, Any] = {"mass": 2.0, "centerOfMass": (0.1, 0.2, -0.3), "diagonalInertia": (0.3, 0.4, 0.5)}
HALF = math.sqrt(0.5)  # Of a quaternion that turns by a right angle.
LOCKED = (1.0, -1.0)  # Limits of a degree of freedom that there is none of.
# What stands below </robot>, in calls of this module.
SOUND = 'body("arm", **ARM), joint("Revolute", "j", "", "arm"), '


def stated(parts: str) -> str:
    """A stage that is stated by calls of this module: its prims, or the whole."""
    (*made,) = eval(f"[{parts}]", {**globals(), "inf": math.inf})
    return str(made[0]) if parts.startswith("stage(") else stage(*made)


def stage(*parts: str, meters: float = 1.0, kilograms: float = 1.0, up: str = "Z") -> str:
    """A stage of prims below </robot>."""
    inner = "\n".join(parts)
    return _HEAD.format(meters=meters, kilograms=kilograms, up=up) + f'def Xform "robot"\n{{\n{inner}\n}}\n'


def body(
    name: str,
    *inside: str,
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    schemas: tuple[str, ...] = ("PhysicsRigidBodyAPI", "PhysicsMassAPI"),
    scale: tuple[float, float, float] | None = None,
    **physics: Any,
) -> str:
    """A rigid body with what it states: mass=1.0, diagonalInertia=(1, 2, 3), ..."""
    types = {"mass": "float", "density": "float", "centerOfMass": "point3f", "diagonalInertia": "float3"}
    types |= {"principalAxes": "quatf", "rigidBodyEnabled": "bool", "kinematicEnabled": "bool", "velocity": "vector3f"}
    lines = [f"{types[key]} physics:{key} = {_text(value)}" for key, value in physics.items()]
    return prim("Xform", name, *lines, *placed(at, scale), *inside, schemas=schemas)


def joint(
    kind: str,
    name: str,
    first: str,
    second: str,
    schemas: tuple[str, ...] = (),
    extra: tuple[str, ...] = (),
    **physics: Any,
) -> str:
    """A joint of a kind such as "Revolute"; "" is the joint by degrees of freedom. Bodies by name, "" for the world."""
    types = {"axis": "uniform token", "lowerLimit": "float", "upperLimit": "float", "jointEnabled": "bool"}
    types |= {"localPos0": "point3f", "localPos1": "point3f", "localRot0": "quatf", "localRot1": "quatf"}
    types |= {"excludeFromArticulation": "uniform bool", "minDistance": "float", "maxDistance": "float"}
    types |= {"breakForce": "float"}
    ends = [f"rel physics:body{k} = </robot/{end}>" for k, end in enumerate((first, second)) if end]
    lines = [f"{types[key]} physics:{key} = {_text(value)}" for key, value in physics.items()]
    return prim(f"Physics{kind}Joint" if kind else "PhysicsJoint", name, *ends, *lines, *extra, schemas=schemas)


def freedoms(limits: Mapping[str, tuple[float, float]], *schemas: str) -> dict[str, tuple[str, ...]]:
    """Arguments of a joint by degrees of freedom, with further schemas."""
    return {
        "schemas": (*schemas, *(f"PhysicsLimitAPI:{name}" for name in limits)),
        "extra": tuple(
            f"float limit:{name}:physics:{end} = {value}"
            for name, pair in limits.items()
            for end, value in zip(("low", "high"), pair, strict=True)
        ),
    }


def planar(*entries: str) -> str:
    """A joint of body "arm" in the plane of x and y, with what else it states."""
    given = freedoms(dict.fromkeys(("transZ", "rotX", "rotY"), LOCKED))
    return joint("", "j", "", "arm", given["schemas"], (*given["extra"], *entries))


def shape(kind: str, name: str, *lines: str, **sizes: Any) -> str:
    """A collision shape: shape("Cube", "c", size=2.0)."""
    types = {"axis": "uniform token"}
    stated = [f"{types.get(key, 'double')} {key} = {_text(value)}" for key, value in sizes.items()]
    return prim(kind, name, *stated, *lines, schemas=("PhysicsCollisionAPI",))


def placed(at: tuple[float, float, float], scale: tuple[float, float, float] | None = None) -> list[str]:
    """Lines that place a prim."""
    ops = ["xformOp:translate", *(["xformOp:scale"] if scale else [])]
    lines = [f"double3 xformOp:translate = {at}", f"uniform token[] xformOpOrder = [{', '.join(map(_quoted, ops))}]"]
    return [*lines, *([f"float3 xformOp:scale = {scale}"] if scale else [])]


def prim(kind: str, name: str, *lines: str, schemas: tuple[str, ...] = ()) -> str:
    """A prim with its lines."""
    applied = f" (prepend apiSchemas = [{', '.join(map(_quoted, schemas))}])" if schemas else ""
    return "\n".join([f'def {kind} "{name}"{applied}', "{", *lines, "}"])


def _quoted(text: str) -> str:
    return f'"{text}"'


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "1" if value else "0"
    return _quoted(value) if isinstance(value, str) else str(value)
