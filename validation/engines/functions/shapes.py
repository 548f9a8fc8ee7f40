"""Solids beside trees: their moments, rays that meet them, how far they are apart."""

from __future__ import annotations

from ..truth.geometry import shapes
from .function import Function, functions_of

_SOLIDS = f"of radius {shapes.RADIUS}, half length {shapes.HALF}, half sides and semi-axes {shapes.SIDES}"


def _distances() -> dict[str, Function]:
    """The first solid at (R, a), the second at (Q, tau + (2, -4, 4))."""
    rows = {
        f"distance_{one}_{other}": (f"distance of a {one} and a {other} (1), {_SOLIDS}", truth)
        for (one, other), truth in shapes.DISTANCES.items()
    }
    rows["distance_ball_in_box"] = (
        f"signed distance of the ball about {shapes.NEAR_FACE} of a box (1), {_SOLIDS}",
        shapes.ball_in_box,
    )
    return functions_of(rows, "turns")


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


SHAPES = _distances() | _rays() | _moments()
