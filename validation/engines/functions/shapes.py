"""Solids beside trees: their moments, rays that meet them, how far they are apart."""

from __future__ import annotations

from ..truth.derived import TruthOf
from ..truth.geometry import shapes
from .function import Function, functions_of

_SOLIDS = f"of radius {shapes.RADIUS}, half length {shapes.HALF}, half sides and semi-axes {shapes.SIDES}"


def _distances() -> dict[str, Function]:
    """The first solid at (R, a), the second at (Q, tau + (2, -4, 4))."""
    rows = {
        f"distance_{one}_{other}": (f"distance of a {one} and a {other} (1), {_SOLIDS}", truth)
        for (one, other), truth in shapes.DISTANCES.items()
    }
    for (one, other), place in shapes.INSIDE.items():
        about = f"signed distance of a {one} at {place} of a {other} that is turned as it is (1), {_SOLIDS}"
        rows[f"distance_{one}_in_{other}"] = (about, shapes.overlap(one, other))
    for one in shapes.MET:
        about = f"signed distance of a floor and of a {one}, turned by R, {shapes.HEIGHT} above it (1), {_SOLIDS}"
        rows[f"distance_{one}_to_floor"] = (about, shapes.to_floor(one))
    return functions_of(rows, "turns")


def _surfaces() -> dict[str, Function]:
    """Surfaces of triangles around solids of the sizes x = |v| + 1/2; a volume has the sign of its surface."""
    rows: dict[str, tuple[str, TruthOf]] = {
        "volume_of_prism": ("of a prism of four sides, x[0] to its edges, x[1] long (1)", shapes.prism_volume),
        "volume_of_pyramid": ("of a pyramid on such a base, x[1] high (1)", shapes.pyramid_volume),
        "volume_of_ring": ("of a ring of four sides, from x[0] to x[0] + x[1], x[2] high (1)", shapes.ring_volume),
        "volume_of_bar": ("of a box with the sides x (1)", shapes.bar_volume),
    }
    for name, factors in shapes.SCALES.items():
        of = f"of the tetrahedron of the origin and of x on the axes, {factors} times as large"
        rows[f"volume_of_tetrahedron{name}"] = (f"{of} (1)", shapes.tetrahedron_volume(factors))
        rows[f"centre_of_tetrahedron{name}"] = (f"mass centre {of} (3)", shapes.tetrahedron_centre(factors))
        rows[f"face_of_tetrahedron{name}"] = (
            f"area and normal of the face opposite the origin {of} (3)",
            shapes.tetrahedron_face(factors),
        )
        rows[f"normal_of_mesh{name}"] = (
            f"unit normal of a surface with the normal v + (4, 8, 8), {factors} times as large (3)",
            shapes.scaled_normal(factors),
        )
    return functions_of(rows, "turns", "defaults and parameters: gears, rotors, dampers, model instances")


def _rays() -> dict[str, Function]:
    """The ray from tau + (2, -4, 4) through the point WITHIN of the solid at (R, a)."""
    of = f"along the ray through {shapes.WITHIN} of it, {_SOLIDS}"
    rows = {f"ray_to_{solid}": (f"distance to a {solid} (1) {of}", shapes.ray(solid)) for solid in shapes.MET}
    for solid in shapes.MET:
        rows[f"ray_out_of_{solid}"] = (f"from that point out of it (1) {of}", shapes.ray_from_within(solid))
    for solid in ("ball", "ellipsoid"):
        rows[f"ray_normal_{solid}"] = (f"unit normal where it enters (3) {of}", shapes.ray_normal(solid))
    return functions_of(rows, "turns")


def _moments() -> dict[str, Function]:
    """Moments (3) about x, y, z through the mass centre of solids of 2 kg, by the sizes x = |v| + 1/2."""
    rows = {
        "moments_box": ("of a box with the sides x", shapes.moments(shapes.box_moments)),
        "moments_ellipsoid": ("of an ellipsoid with the semi-axes x", shapes.moments(shapes.ellipsoid_moments)),
        "moments_ball": ("of a ball of radius x[0]", shapes.moments(shapes.ball_moments)),
        "moments_shell": ("of a ball's surface of radius x[0]", shapes.moments(shapes.shell_moments)),
        "moments_cylinder": (
            "of a cylinder along z of radius x[0] and length x[1]",
            shapes.moments(shapes.cylinder_moments),
        ),
        "moments_capsule": (
            "of a capsule along z of radius x[0], of length x[1] without its ends",
            shapes.moments(shapes.capsule_moments),
        ),
        "principal_moments": ("of R diag(1 + v^2 / (1 + v^2)) R^T, the least first (3)", shapes.principal_moments),
    }
    return functions_of(rows, "turns")


SHAPES = _distances() | _rays() | _moments() | _surfaces()
