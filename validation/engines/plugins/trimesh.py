"""trimesh: mass properties of solids whose surfaces are triangles, rotations and placements; no mechanics."""

from __future__ import annotations

import numpy as np

from ..interface import Array, Convention, Link, Tree, Unsupported
from . import turns
from .turns import trimesh as turning
from .writing.source import Source, SourcePlugin, ways_of

_SOLIDS = {
    "box by its sizes": "trimesh.creation.box(extents={size})",
    "box by its corners": "trimesh.creation.box(bounds=[{low}, {high}])",
    "box by its corners, the other way round": "trimesh.creation.box(bounds=[{high}, {low}])",
    "box by its triangles": "trimesh.Trimesh(*triangles({low}, {high}))",
    "box that is moved": "trimesh.creation.box(extents={size}).apply_translation({middle})",
    "primitive box": "trimesh.primitives.Box(extents={size}, transform={pose})",
    "primitive box by its corners": "trimesh.primitives.Box(bounds=[{low}, {high}])",
    "primitive box by its corners, the other way round": "trimesh.primitives.Box(bounds=[{high}, {low}])",
    "primitive sphere": "trimesh.primitives.Sphere(radius={radius}, center={middle})",
    "primitive cylinder": "trimesh.primitives.Cylinder(radius={radius}, height={length}, transform={pose})",
    "primitive capsule": "trimesh.primitives.Capsule(radius={radius}, height={length}, transform={pose})",
}
_OF_A_DENSITY = " of a density"
_TRIANGLES = (
    "def triangles(low, high):",
    "    corners = [[(low, high)[k >> j & 1][j] for j in range(3)] for k in range(8)]",
    "    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]",
    "    return corners, [t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))]",
)
WAYS = ways_of("""
== solid_inertia | mass_properties
I = solid.moment_inertia
value = [solid.mass, *solid.center_mass, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]]
== solid_inertia:volume | volume, moment_inertia_frame
I = solid.moment_inertia_frame(np.eye(4)).copy()
c = solid.center_mass
m = density * solid.volume
I -= m * (c @ c * np.eye(3) - np.outer(c, c))
value = [m, *c, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]]
== solid_mass | volume | value = [density * solid.volume]
== # Of a ball and a cylinder these are formulas; all else is of the triangles that stand for them.
== solid_inertia:primitive | primitives: volume, moment_inertia
I = solid.moment_inertia
m = density * solid.volume
value = [m, *solid.center_mass, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]]
""")


def _pose(R: Array, p: Array) -> Array:
    return np.block([[R, p[:, np.newaxis]], [np.zeros((1, 3)), np.ones((1, 1))]])


def _sizes(name: str, body: Link) -> dict[str, Array]:
    """What the moments of a solid about its middle say of its sizes, and its volume."""
    moments = np.diag(np.array(body.inertia)) / body.mass
    if "ball" in name:
        radius = np.sqrt(2.5 * moments[0])
        return {"radius": radius, "volume": 4.0 / 3.0 * np.pi * radius**3}
    if "capsule" in name:
        # Between its ends it is as long as it is wide: of the moment about its axis, 23/50 of the radius squared.
        radius = np.sqrt(moments[2] / 0.46)
        return {"radius": radius, "length": 2.0 * radius, "volume": 10.0 / 3.0 * np.pi * radius**3}
    if "cylinder" in name:
        radius = np.sqrt(2.0 * moments[2])
        length = np.sqrt(12.0 * moments[0] - 3.0 * radius**2)
        return {"radius": radius, "length": length, "volume": np.pi * radius**2 * length}
    size, middle = np.sqrt(6.0 * (moments.sum() - 2.0 * moments)), np.array(body.joints[0].p)
    return {"size": size, "low": middle - size / 2.0, "high": middle + size / 2.0, "volume": np.prod(size)}


def write(tree: Tree) -> Source | Unsupported:
    """Text that makes a solid."""
    if tree.asked == "turns":
        return turns.source(*turning.IMPORTS)
    name = tree.name.removesuffix(_OF_A_DENSITY)
    if name not in _SOLIDS:
        return Unsupported("no such solid", offered=False)
    (body,) = tree.links
    (joint,) = body.joints
    middle = np.array(joint.p) + 0.0
    parts = {"pose": _pose(np.array(joint.R), middle), "middle": middle}
    parts |= {part: np.round(value, 12) for part, value in _sizes(name, body).items()}
    volume, is_round = parts.pop("volume"), "radius" in parts
    solid = _SOLIDS[name].format(**{part: value.tolist() for part, value in parts.items()})
    density = body.mass / float(volume)
    lines = (
        "import numpy as np",
        "import trimesh",
        *_TRIANGLES,
        f"density = {round(density, 12)!r}",
        f"solid = {solid}",
    )
    lacks: tuple[str, ...] = ("solid_inertia", "solid_inertia:volume") if is_round else ("solid_inertia:primitive",)
    if "capsule" in name:  # Its moments are those of facets; its volume is a formula.
        lacks += ("solid_inertia:primitive",)
    return Source((*lines, "solid.density = density"), ((),), 0, 0, lacks=lacks)


PLUGIN = SourcePlugin(
    name="trimesh",
    package="trimesh",
    extra="trimesh",
    conventions=(
        Convention("moments", "about the mass centre, along the axes of the file"),
        Convention("quaternion", "w, x, y, z"),
    ),
    kinds={},
    ways=WAYS | turning.WAYS,
    write=write,
    demands={"solids": "box, Trimesh", "turns": "transformations, registration"},
)
