"""USD: UsdPhysics of rigid bodies on joints (openusd.org, UsdPhysics)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from . import readers
from .readers import NEXT, Reading, about, along, hung

_of = partial(readers.reading, "usd")
_UNTURNED = "(1, 0, 0, 0)"


def _file(axis: str = 'uniform token physics:axis = "Y"', axes: str = _UNTURNED, at: str = "(0, 0, 0.5)") -> str:
    """A body on a joint in the world: the joint's axis, the principal axes, where the joint stands."""
    return f"""#usda 1.0
(
    defaultPrim = "m"
    metersPerUnit = 1
    kilogramsPerUnit = 1
    upAxis = "Z"
)
def PhysicsScene "scene" {{
    vector3f physics:gravityDirection = (0, 0, -1)
    float physics:gravityMagnitude = 9.81
}}
def Xform "m" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {{
    def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {{
        double3 xformOp:translate = {at}
        uniform token[] xformOpOrder = ["xformOp:translate"]
        float physics:mass = 1
        point3f physics:centerOfMass = (0, 0.125, 0.25)
        float3 physics:diagonalInertia = (0.25, 0.375, 0.5)
        quatf physics:principalAxes = {axes}
    }}
    def PhysicsRevoluteJoint "joint" {{
        rel physics:body1 = </m/b>
        point3f physics:localPos0 = {at}
        {axis}
    }}
}}
"""


def files() -> dict[str, Reading]:
    """All of them, by name; numbers that floats state exactly."""
    inertia = readers.diagonal(0.25, 0.375, 0.5)
    body = replace(hung(NEXT), parent=-1, com=(0.0, 0.125, 0.25), inertia=inertia)

    def stated() -> Iterator[tuple[str, Reading]]:
        yield _of("plain", _file(), body)
        yield _of("axis left out", _file(axis=""), hung(body, axis=(1.0, 0.0, 0.0)))
        half = about((1.0, 0.0, 0.0), 1.5707963267948966)
        turned = replace(body, inertia=along(half, inertia))
        yield _of("principal axes turned", _file(axes="(0.70710678, 0.70710678, 0, 0)"), turned)

    return dict(stated())
