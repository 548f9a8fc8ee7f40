"""A process that reads one USD stage: a script of its own, which imports nothing else of this package.

Layers are parsed by OpenUSD's C++, which a file from elsewhere may crash or keep busy; here memory, time and
environment are bounded. It reads {"file"} as JSON, and writes what the stage states of bodies, joints, shapes and
gravity, in the stage's units, as {"stage"}; with it, or alone, come the "layers" that it is made of, and what is
"missing" of them; or {"fault"}. Matrices are USD's, which multiply rows: p' = p M.
"""

from __future__ import annotations

import json
import math
import os
import struct
import sys
from collections.abc import Iterable
from typing import Any

MEMORY = 4 << 30  # [bytes]; OpenUSD maps its files, and reserves stacks for threads.
SECONDS = 60  # of processor time
MAX_PRIMS = 200_000
MAX_FAULT = 2000  # Characters of what went wrong, of which the parent shows fewer.
MAX_LAYERS = 10_000
MAX_MISSING = 20

# Joint prim -> kind.
_JOINTS = {
    "PhysicsFixedJoint": "fixed",
    "PhysicsRevoluteJoint": "revolute",
    "PhysicsPrismaticJoint": "prismatic",
    "PhysicsSphericalJoint": "spherical",
    "PhysicsDistanceJoint": "distance",
    "PhysicsJoint": "d6",
}
_FREEDOMS = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
# Shapes of UsdGeom, with the attributes that are their sizes.
_SHAPES = {
    "Cube": ("size",),
    "Sphere": ("radius",),
    "Cylinder": ("radius", "height", "axis"),
    "Capsule": ("radius", "height", "axis"),
    "Cone": ("radius", "height", "axis"),
    "Plane": ("axis",),
    "Mesh": (),
    "Cylinder_1": (),
    "Capsule_1": (),
    "Points": (),
}
# Mass properties of a body, read whether or not its schema for them is applied.
_MASS = ("mass", "density", "centerOfMass", "diagonalInertia", "principalAxes")
# Attributes of joints that extensions of UsdPhysics define, which are read where they are authored.
_EXTENSIONS = (
    "physxJoint:armature",
    "physxJoint:jointFriction",
    "physxJoint:maxJointVelocity",
    "newton:armature",
    "newton:damping",
    "newton:friction",
    "newton:velocityLimit",
    "urdf:limit:effort",
)


def bound() -> None:
    """Bound memory and time, where the system can."""
    try:
        import resource  # Windows has none.
    except ImportError:
        return
    for what, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, SECONDS), (resource.RLIMIT_FSIZE, 0)):
        hard = resource.getrlimit(what)[1]
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)  # A bound that is set is never raised.
        try:
            resource.setrlimit(what, (least, least))
        except (OSError, ValueError):  # Not every system bounds the address space.
            continue


def number(value: Any) -> Any:
    """A value of an attribute as JSON has it: numbers, lists of them, or a text; infinities and NaN by their names.

    Numbers of single precision are the shortest decimals that stand for them, which is what a text file states.
    """
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else repr(value)
    if hasattr(value, "GetReal"):  # A quaternion: w, x, y, z.
        return [number(value.GetReal()), *number(value.GetImaginary())]
    return [number(item) for item in value]


def shortest(value: Any, single: bool) -> Any:
    """Numbers of single precision by their shortest decimals."""
    if isinstance(value, list):
        return [shortest(item, single) for item in value]
    if not single or not isinstance(value, float):
        return value
    for digits in range(6, 10):
        text = float(f"{value:.{digits}g}")
        if _single(text) == value:
            return text
    return value


def _single(value: float) -> float:
    return float(struct.unpack("f", struct.pack("f", value))[0])


def authored(prim: Any, name: str) -> Any:
    """The value of an attribute where the file states one; None elsewhere."""
    attribute = prim.GetAttribute(name)
    if not attribute or not attribute.HasAuthoredValue():
        return None
    type_name = str(attribute.GetTypeName())
    single = any(word in type_name for word in ("float", "3f", "quatf", "half", "3h", "quath"))
    return shortest(number(attribute.Get(_time())), single)


def _time() -> Any:
    from pxr import Usd  # An extra, looked for by `main`.

    return Usd.TimeCode.EarliestTime()


def stage_data(file: str) -> dict[str, Any]:
    """Contents of a stage: "stage", its "layers" and what is "missing"; or a "fault"."""
    from pxr import Usd, UsdGeom, UsdPhysics  # An extra, looked for by `main`.

    stage = Usd.Stage.Open(file)
    layers = sorted({place for layer in stage.GetUsedLayers() if not layer.anonymous for place in places(layer)})
    if len(layers) > MAX_LAYERS:
        return {"fault": f"it is made of more than {MAX_LAYERS} layers"}
    missing = [printable(" ".join(str(error).split())) for error in stage.GetCompositionErrors()]
    if missing:
        return {"layers": layers, "missing": sorted(set(missing))[:MAX_MISSING]}
    cache = UsdGeom.XformCache(_time())
    data: dict[str, Any] = {
        "name": stage.GetDefaultPrim().GetName() if stage.GetDefaultPrim() else "",
        "meters": UsdGeom.GetStageMetersPerUnit(stage),
        "kilograms": UsdPhysics.GetStageKilogramsPerUnit(stage),
        "up": str(UsdGeom.GetStageUpAxis(stage)),
        "other units": _other_units(stage),
        "scenes": [],
        "bodies": [],
        "joints": [],
        "shapes": [],
        "roots": [],
        "placements": {},
    }
    prims = Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies())
    carrier: dict[str, str] = {}  # Rigid body that a prim belongs to, keyed by path.
    for count, prim in enumerate(prims):
        if count > MAX_PRIMS:
            return {"fault": f"it has more than {MAX_PRIMS} prims"}
        _take_prim(prim, data, carrier)
    data["carrier"] = {path: body for path, body in carrier.items() if body}
    wanted = {body["path"] for body in data["bodies"]} | {shape["path"] for shape in data["shapes"]}
    wanted |= {end for joint in data["joints"] for end in (joint["body0"], joint["body1"]) if end}
    for path in sorted(wanted & carrier.keys()):  # An inactive, abstract or undefined prim is no part of the scene.
        prim = stage.GetPrimAtPath(path)
        if prim:
            matrix = cache.GetLocalToWorldTransform(prim)
            data["placements"][path] = [number(list(matrix.GetRow(row))) for row in range(4)]
    return {"stage": data, "layers": layers, "missing": []}


def _take_prim(prim: Any, data: dict[str, Any], carrier: dict[str, str]) -> None:
    """Note what a prim is: a body, a root, a scene, a joint, a shape."""
    from pxr import UsdGeom, UsdPhysics  # An extra, looked for by `main`.

    path, kind = str(prim.GetPath()), str(prim.GetTypeName())
    own = carrier.get(str(prim.GetPath().GetParentPath()), "")
    if prim.HasAPI(UsdPhysics.RigidBodyAPI):
        own = path
        data["bodies"].append(_body(prim))
    carrier[path] = own
    if prim.HasAPI(UsdPhysics.ArticulationRootAPI):
        data["roots"].append(path)
    if prim.IsA(UsdPhysics.Scene):
        data["scenes"].append(_scene(prim))
    elif prim.IsA(UsdPhysics.Joint):
        data["joints"].append(_joint(prim, kind))
    elif prim.IsA(UsdGeom.Gprim) and own:
        data["shapes"].append(_shape(prim, kind, own))


def places(layer: Any) -> list[str]:
    """Files that a layer lies in: its path, and of a member of a package (FILE.usdz[MEMBER]) the package's.

    A file may have brackets in its name: both are said, and both have to lie where files may be read.
    """
    from pxr import Ar  # An extra, looked for by `main`.

    path = layer.realPath
    package = Ar.SplitPackageRelativePathOuter(path)[0]
    return [package] if package != path and not os.path.lexists(path) else [package, path]


def _other_units(stage: Any) -> list[tuple[str, str, str]]:
    """Layer, metadata and value, where a layer states another unit or axis than the stage: OpenUSD converts nothing."""
    from pxr import UsdGeom, UsdPhysics  # An extra, looked for by `main`.

    own = {
        "metersPerUnit": UsdGeom.GetStageMetersPerUnit(stage),
        "kilogramsPerUnit": UsdPhysics.GetStageKilogramsPerUnit(stage),
        "upAxis": str(UsdGeom.GetStageUpAxis(stage)),
    }
    stated = (
        (layer.GetDisplayName(), name, str(layer.pseudoRoot.GetInfo(name)), value)
        for layer in stage.GetUsedLayers()
        for name, value in own.items()
        if layer != stage.GetRootLayer() and layer.pseudoRoot.HasInfo(name)
    )
    return sorted((layer, name, text) for layer, name, text, value in stated if text != str(value))


def _schemas(prim: Any) -> list[str]:
    """Names of the API schemas that are applied to a prim, unknown ones too."""
    return [str(name) for name in prim.GetPrimTypeInfo().GetAppliedAPISchemas()]


def _unread(prim: Any, read: Iterable[str] = ()) -> list[str]:
    """Stated properties of physics that the prim's schemas don't have and nothing reads, misspelt ones among them."""
    known = {*prim.GetPrimDefinition().GetPropertyNames(), *read}
    names = [str(stated.GetName()) for stated in prim.GetAuthoredProperties()]
    return [name for name in names if name.partition(":")[0] in ("physics", "drive", "limit") and name not in known]


def _body(prim: Any) -> dict[str, Any]:
    return {
        "unread": _unread(prim, [f"physics:{name}" for name in _MASS]),
        "path": str(prim.GetPath()),
        "enabled": authored(prim, "physics:rigidBodyEnabled"),
        "kinematic": authored(prim, "physics:kinematicEnabled"),
        "moving": [authored(prim, f"physics:{name}") for name in ("velocity", "angularVelocity")],
        "schemas": _schemas(prim),
        **_mass(prim),
    }


def _mass(prim: Any) -> dict[str, Any]:
    return {"inertia": authored(prim, "newton:inertia"), **{name: authored(prim, f"physics:{name}") for name in _MASS}}


def _scene(prim: Any) -> dict[str, Any]:
    names = ("gravityDirection", "gravityMagnitude")
    return {"path": str(prim.GetPath()), **{name: authored(prim, f"physics:{name}") for name in names}}


def _joint(prim: Any, kind: str) -> dict[str, Any]:
    from pxr import UsdPhysics  # An extra, looked for by `main`.

    ends = []
    for relationship in (UsdPhysics.Joint(prim).GetBody0Rel(), UsdPhysics.Joint(prim).GetBody1Rel()):
        targets = relationship.GetForwardedTargets()
        ends.append([str(target) for target in targets])
    schemas = _schemas(prim)
    drives = [name.partition(":")[2] for name in schemas if name.startswith("PhysicsDriveAPI:")]
    return {
        "path": str(prim.GetPath()),
        "kind": _JOINTS.get(kind, kind),
        "body0": ends[0][0] if ends[0] else "",
        "body1": ends[1][0] if ends[1] else "",
        "targets": max(len(ends[0]), len(ends[1])),
        "unread": _unread(prim),
        "schemas": schemas,
        "position0": authored(prim, "physics:localPos0"),
        "rotation0": authored(prim, "physics:localRot0"),
        "position1": authored(prim, "physics:localPos1"),
        "rotation1": authored(prim, "physics:localRot1"),
        "axis": authored(prim, "physics:axis"),
        "lower": authored(prim, "physics:lowerLimit"),
        "upper": authored(prim, "physics:upperLimit"),
        "enabled": authored(prim, "physics:jointEnabled"),
        "excluded": authored(prim, "physics:excludeFromArticulation"),
        "breaks": [authored(prim, f"physics:{name}") for name in ("breakForce", "breakTorque")],
        "cones": [authored(prim, f"physics:coneAngle{k}Limit") for k in (0, 1)],
        "distances": [authored(prim, f"physics:{name}") for name in ("minDistance", "maxDistance")],
        "limits": {
            name: [authored(prim, f"limit:{name}:physics:{end}") for end in ("low", "high")]
            for name in (*_FREEDOMS, "distance")
            if f"PhysicsLimitAPI:{name}" in schemas
        },
        "drives": {name: {"maxForce": authored(prim, f"drive:{name}:physics:maxForce")} for name in drives},
        "extensions": {name: value for name in _EXTENSIONS if (value := authored(prim, name)) is not None},
    }


def _shape(prim: Any, kind: str, body: str) -> dict[str, Any]:
    from pxr import UsdGeom, UsdPhysics, UsdShade  # An extra, looked for by `main`.

    density = None
    material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
    if material:
        density = authored(material.GetPrim(), "physics:density")
    colors = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get(_time())
    return {
        "path": str(prim.GetPath()),
        "body": body,
        "kind": kind,
        "sizes": {name: number(prim.GetAttribute(name).Get(_time())) for name in _SHAPES.get(kind, ())},
        "collides": prim.HasAPI(UsdPhysics.CollisionAPI) and authored(prim, "physics:collisionEnabled") is not False,
        "seen": str(UsdGeom.Imageable(prim).ComputePurpose()) in ("default", "render"),
        "color": number(colors[0]) if colors else None,
        "material density": density,
        **_mass(prim),
    }


def printable(text: str) -> str:
    """The beginning of a text, its control characters and surrogates escaped, for terminals and logs."""
    return "".join(c if c.isprintable() or c == "\n" else f"\\u{ord(c):04x}" for c in text[:MAX_FAULT])


def main() -> None:
    """Read the stage that the task on standard input names, and write the answer as JSON."""
    task = json.load(sys.stdin)
    answers = os.dup(1)
    os.dup2(2, 1)  # What OpenUSD prints is no answer.
    os.environ.clear()
    os.environ["PXR_WORK_THREAD_LIMIT"] = "1"
    bound()
    try:
        import pxr.Usd  # noqa: F401 - an extra, whose absence is an answer
    except ImportError:
        answer: dict[str, Any] = {"absent": "usd-core"}
    else:
        try:
            answer = stage_data(task["file"])
        except BaseException as error:  # Also what is no Exception: the parent says it, whatever it is.
            answer = {"fault": printable(str(error).strip() or type(error).__name__)}
    with os.fdopen(answers, "w", encoding="utf-8") as out:
        out.write(json.dumps(answer))


if __name__ == "__main__":
    main()
