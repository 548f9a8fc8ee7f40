"""Drake's factories of inertias, of solids, meshes and hulls, and what its classes of inertias do."""

from __future__ import annotations

from ...truth.geometry.bodies import CORNERS, DENSITY, DENTED
from ...truth.geometry.poses import ASIDE, CENTRE, MASS, MOMENTS
from ..writing.source import Way

# Sizes x, direction u; what says of an inertia all that it has.
_BEGIN = f"""x, u = np.abs(v) + 0.5, v2 + {list(ASIDE)}
u = u / np.linalg.norm(u)
def told(I):
    J = I.CalcRotationalInertia()
    return [I.get_mass(), *I.get_com(), *J.get_moments(), *J.get_products()]
"""
# Solid -> name, arguments of factories.
_FACTORIES = {
    "box": ("SolidBox", "x[0], x[1], x[2]"),
    "cube": ("SolidCube", "x[0]"),
    "ellipsoid": ("SolidEllipsoid", "x[0], x[1], x[2]"),
    "ball": ("SolidSphere", "x[0]"),
    "shell": ("HollowSphere", "x[0]"),
    "cylinder": ("SolidCylinder", "x[0], x[1], u"),
    "capsule": ("SolidCapsule", "x[0], x[1], u"),
}
_SHAPES = {
    "box": "Box(*x)",
    "ellipsoid": "Ellipsoid(*x)",
    "ball": "Sphere(x[0])",
    "cylinder": "Cylinder(x[0], x[1])",
    "capsule": "Capsule(x[0], x[1])",
}
_CORNERS = f"corners = np.array({[*map(list, CORNERS)]}) * x\n"
_FILE = f"""{_CORNERS}from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.obj')
for p in corners: print('v', *(repr(float(y)) for y in p), file=file)
for f in {[tuple(k + 1 for k in one) for one in DENTED]}: print('f', *f, file=file, flush=True)
"""
_TRIANGLES = (
    f"{_CORNERS}triangles = [drake.SurfaceTriangle(*f) for f in {[*DENTED]}]\n"
    "mesh = drake.TriangleSurfaceMesh(triangles=triangles, vertices=corners)\n"
)


def _spatial(of: str) -> str:
    return f"{_BEGIN}value = told(drake.SpatialInertia.{of})"


def _unit(of: str) -> str:
    """Of a unit inertia about the mass centre."""
    return f"{_BEGIN}value = told(drake.SpatialInertia({MASS}, np.zeros(3), drake.UnitInertia.{of}))"


WAYS = {
    f"solid_{one}_of_density": Way(
        f"SpatialInertia.{name}WithDensity", _spatial(f"{name}WithDensity({DENSITY}, {arguments})")
    )
    for one, (name, arguments) in _FACTORIES.items()
}
WAYS |= {
    f"solid_{one}_of_mass": Way(f"SpatialInertia.{name}WithMass", _spatial(f"{name}WithMass({MASS}, {arguments})"))
    for one, (name, arguments) in _FACTORIES.items()
    if one != "cube"
}
WAYS |= {
    f"solid_{one}_of_mass:UnitInertia": Way(f"UnitInertia.{name}", _unit(f"{name}({arguments})"))
    for one, (name, arguments) in _FACTORIES.items()
}
WAYS |= {
    f"shape_{one}": Way(
        "CalcSpatialInertia", f"{_BEGIN}value = told(drake.CalcSpatialInertia(drake.{shape}, {DENSITY}))"
    )
    for one, shape in _SHAPES.items()
}
WAYS |= {
    f"volume_{one}": Way("CalcVolume", f"{_BEGIN}value = [drake.CalcVolume(drake.{shape})]")
    for one, shape in _SHAPES.items()
}
_J = f"""R = drake.RotationMatrix(drake.Quaternion(q))
m = np.array({[*map(list, MOMENTS)]})
J = drake.RotationalInertia(*np.diag(m), m[0, 1], m[0, 2], m[1, 2])
"""
_SIX = "value = [*J.get_moments(), *J.get_products()]"
_WHOLE = f"{_J}I = drake.SpatialInertia.MakeFromCentralInertia({MASS}, {list(CENTRE)}, J)\n"
WAYS |= {
    "cylinder_about_end_of_density": Way(
        "SpatialInertia.SolidCylinderWithDensityAboutEnd",
        _spatial(f"SolidCylinderWithDensityAboutEnd({DENSITY}, x[0], x[1], u)"),
    ),
    "cylinder_about_end_of_mass": Way(
        "SpatialInertia.SolidCylinderWithMassAboutEnd",
        _spatial(f"SolidCylinderWithMassAboutEnd({MASS}, x[0], x[1], u)"),
    ),
    "cylinder_about_end_of_mass:UnitInertia": Way(
        "UnitInertia.SolidCylinderAboutEnd",
        f"{_BEGIN}value = told(drake.SpatialInertia({MASS}, u * x[1] / 2, "
        "drake.UnitInertia.SolidCylinderAboutEnd(x[0], x[1], u)))",
    ),
    "rod": Way("SpatialInertia.ThinRodWithMass", _spatial(f"ThinRodWithMass({MASS}, x[0], u)")),
    "rod:UnitInertia": Way("UnitInertia.ThinRod", _unit("ThinRod(x[0], u)")),
    "rod:StraightLine": Way("UnitInertia.StraightLine", _unit("StraightLine(x[0] ** 2 / 12, u)")),
    "rod_about_end": Way(
        "SpatialInertia.ThinRodWithMassAboutEnd", _spatial(f"ThinRodWithMassAboutEnd({MASS}, x[0], u)")
    ),
    "solid_cylinder_of_mass:AxiallySymmetric": Way(
        "UnitInertia.AxiallySymmetric",
        _unit("AxiallySymmetric(x[0] ** 2 / 2, x[0] ** 2 / 4 + x[1] ** 2 / 12, u)"),
    ),
    "solid_ball_of_mass:TriaxiallySymmetric": Way(
        "UnitInertia.TriaxiallySymmetric", _unit("TriaxiallySymmetric(0.4 * x[0] ** 2)")
    ),
    "point_mass": Way(
        "UnitInertia.PointMass",
        f"{_BEGIN}value = told(drake.SpatialInertia({MASS}, v, drake.UnitInertia.PointMass(v)))",
    ),
    "mesh_dented": Way(
        "CalcSpatialInertia of a TriangleSurfaceMesh",
        f"{_BEGIN}{_TRIANGLES}value = told(drake.CalcSpatialInertia(mesh, {DENSITY}))",
    ),
    "mesh_dented:Mesh": Way(
        "CalcSpatialInertia of a Mesh",
        f"{_BEGIN}{_FILE}value = told(drake.CalcSpatialInertia(drake.Mesh(file.name, 1.0), {DENSITY}))",
    ),
    "convex_hull_of_mesh": Way(
        "CalcSpatialInertia of a Convex",
        f"{_BEGIN}{_FILE}value = told(drake.CalcSpatialInertia(drake.Convex(file.name, 1.0), {DENSITY}))",
    ),
    "mesh_scaled": Way(
        "CalcSpatialInertia of a Mesh with a scale",
        f"{_BEGIN}{_FILE}value = told(drake.CalcSpatialInertia(drake.Mesh(file.name, 2.0), {DENSITY}))",
    ),
    "mesh_scaled_apart": Way(
        "CalcSpatialInertia of a Mesh with three scales",
        f"{_BEGIN}{_FILE}value = told(drake.CalcSpatialInertia("
        f"drake.Mesh(file.name, scale3=[2.0, 0.5, 4.0]), {DENSITY}))",
    ),
    "convex_hull_scaled_apart": Way(
        "CalcSpatialInertia of a Convex with three scales",
        f"{_BEGIN}{_FILE}value = told(drake.CalcSpatialInertia("
        f"drake.Convex(file.name, scale3=[2.0, 0.5, 4.0]), {DENSITY}))",
    ),
    "moments_turned": Way("RotationalInertia.ReExpress", f"{_J}J = J.ReExpress(R)\n{_SIX}"),
    "moments_turned:UnitInertia": Way(
        "UnitInertia.ReExpress",
        f"{_J}G = drake.UnitInertia(*np.diag(m), m[0, 1], m[0, 2], m[1, 2]).ReExpress(R)\n"
        "value = [*G.get_moments(), *G.get_products()]",
    ),
    "moments_turned:principal": Way(
        "CalcPrincipalMomentsAndAxesOfInertia",
        f"{_J}x, P = J.ReExpress(R).CalcPrincipalMomentsAndAxesOfInertia()\n"
        "P = P.matrix() @ np.diag(x) @ P.matrix().T\n"
        "value = [P[0, 0], P[1, 1], P[2, 2], P[0, 1], P[0, 2], P[1, 2]]",
    ),
    "moments_shifted": Way(
        "RotationalInertia.ShiftFromCenterOfMass", f"{_J}J = J.ReExpress(R).ShiftFromCenterOfMass({MASS}, -v)\n{_SIX}"
    ),
    "moments_shifted:sum": Way(
        "RotationalInertia +, UnitInertia.PointMass",
        f"{_J}K = drake.UnitInertia.PointMass(v)\nJ = J.ReExpress(R) + K * {MASS}\n{_SIX}",
    ),
    "moments_turned:ShiftToCenterOfMass": Way(
        "RotationalInertia.ShiftToCenterOfMass",
        f"{_J}J = J.ReExpress(R).ShiftFromCenterOfMass({MASS}, -v).ShiftToCenterOfMass({MASS}, v)\n{_SIX}",
    ),
    "moments_shifted_on": Way(
        "RotationalInertia.ShiftToThenAwayFromCenterOfMass",
        f"{_J}J = J.ReExpress(R).ShiftFromCenterOfMass({MASS}, "
        f"-v).ShiftToThenAwayFromCenterOfMass({MASS}, v, v2)\n{_SIX}",
    ),
    "moments_shifted:UnitInertia": Way(
        "UnitInertia.SetFromRotationalInertia, ShiftFromCenterOfMass",
        f"{_J}G = drake.UnitInertia().SetFromRotationalInertia(J, {MASS}).ReExpress(R).ShiftFromCenterOfMass(-v)\n"
        f"value = {MASS} * np.r_[G.get_moments(), G.get_products()]",
    ),
    "first_moment": Way("SpatialInertia.CalcComMoment", f"{_WHOLE}value = I.CalcComMoment()"),
    "moments_traced": Way(
        "RotationalInertia.Trace, CalcMaximumPossibleMomentOfInertia",
        f"{_J}value = [J.Trace(), J.CalcMaximumPossibleMomentOfInertia()]",
    ),
    "moments_turned:ellipsoid": Way(
        "CalcPrincipalSemiDiametersAndPoseForSolidEllipsoid",
        f"{_WHOLE}lengths, X = I.ReExpress(R).CalcPrincipalSemiDiametersAndPoseForSolidEllipsoid()\n"
        "P = X.rotation().matrix()\n"
        f"P = {MASS} / 5 * P @ (np.sum(lengths**2) * np.eye(3) - np.diag(lengths**2)) @ P.T\n"
        "value = [P[0, 0], P[1, 1], P[2, 2], P[0, 1], P[0, 2], P[1, 2]]",
    ),
}
