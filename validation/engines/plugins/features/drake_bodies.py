"""Drake's factories of inertias, of solids, meshes and hulls, and what its classes of inertias do."""

from __future__ import annotations

from ...truth.geometry.bodies import CORNERS, DENSITY, DENTED
from ...truth.geometry.poses import ASIDE, CENTRE, MASS, MOMENTS
from ..writing.source import Way, ways_of

# Sizes x, direction u; what says of an inertia all that it has.
_BEGIN = f"""x, u = np.abs(v) + 0.5, v2 + {list(ASIDE)}
u = u / np.linalg.norm(u)
def properties(I):
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
    return f"{_BEGIN}value = properties(drake.SpatialInertia.{of})"


def _unit(of: str) -> str:
    """Moments of a unit inertia about the mass centre."""
    return f"{_BEGIN}value = properties(drake.SpatialInertia({MASS}, np.zeros(3), drake.UnitInertia.{of}))"


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
        "CalcSpatialInertia", f"{_BEGIN}value = properties(drake.CalcSpatialInertia(drake.{shape}, {DENSITY}))"
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
_SOLID_CYLINDER_WITH_DENSITY_ABOUT_END = _spatial(f"SolidCylinderWithDensityAboutEnd({DENSITY}, x[0], x[1], u)")
_SOLID_CYLINDER_WITH_MASS_ABOUT_END = _spatial(f"SolidCylinderWithMassAboutEnd({MASS}, x[0], x[1], u)")
_ABOUT_END = "SolidCylinderAboutEnd(x[0], x[1], u)"
_THIN_ROD_WITH_MASS = _spatial(f"ThinRodWithMass({MASS}, x[0], u)")
_THIN_ROD_WITH_MASS_ABOUT_END = _spatial(f"ThinRodWithMassAboutEnd({MASS}, x[0], u)")
WAYS |= ways_of(f"""
== cylinder_about_end_of_density | SpatialInertia.SolidCylinderWithDensityAboutEnd
{_SOLID_CYLINDER_WITH_DENSITY_ABOUT_END}
== cylinder_about_end_of_mass | SpatialInertia.SolidCylinderWithMassAboutEnd | {_SOLID_CYLINDER_WITH_MASS_ABOUT_END}
== cylinder_about_end_of_mass:UnitInertia | UnitInertia.SolidCylinderAboutEnd
{_BEGIN}value = properties(drake.SpatialInertia({MASS}, u * x[1] / 2, drake.UnitInertia.{_ABOUT_END}))
== rod | SpatialInertia.ThinRodWithMass | {_THIN_ROD_WITH_MASS}
== rod:UnitInertia | UnitInertia.ThinRod | {_unit("ThinRod(x[0], u)")}
== rod:StraightLine | UnitInertia.StraightLine | {_unit("StraightLine(x[0] ** 2 / 12, u)")}
== rod_about_end | SpatialInertia.ThinRodWithMassAboutEnd | {_THIN_ROD_WITH_MASS_ABOUT_END}
== solid_cylinder_of_mass:AxiallySymmetric | UnitInertia.AxiallySymmetric
{_unit("AxiallySymmetric(x[0] ** 2 / 2, x[0] ** 2 / 4 + x[1] ** 2 / 12, u)")}
== solid_ball_of_mass:TriaxiallySymmetric | UnitInertia.TriaxiallySymmetric
{_unit("TriaxiallySymmetric(0.4 * x[0] ** 2)")}
== point_mass | UnitInertia.PointMass
{_BEGIN}value = properties(drake.SpatialInertia({MASS}, v, drake.UnitInertia.PointMass(v)))
== mesh_dented | CalcSpatialInertia of a TriangleSurfaceMesh
{_BEGIN}{_TRIANGLES}value = properties(drake.CalcSpatialInertia(mesh, {DENSITY}))
== mesh_dented:Mesh | CalcSpatialInertia of a Mesh
{_BEGIN}{_FILE}value = properties(drake.CalcSpatialInertia(drake.Mesh(file.name, 1.0), {DENSITY}))
== convex_hull_of_mesh | CalcSpatialInertia of a Convex
{_BEGIN}{_FILE}value = properties(drake.CalcSpatialInertia(drake.Convex(file.name, 1.0), {DENSITY}))
== mesh_scaled | CalcSpatialInertia of a Mesh with a scale
{_BEGIN}{_FILE}value = properties(drake.CalcSpatialInertia(drake.Mesh(file.name, 2.0), {DENSITY}))
== mesh_scaled_apart | CalcSpatialInertia of a Mesh with three scales
{_BEGIN}{_FILE}value = properties(drake.CalcSpatialInertia(drake.Mesh(file.name, scale3=[2.0, 0.5, 4.0]), {DENSITY}))
== convex_hull_scaled_apart | CalcSpatialInertia of a Convex with three scales
{_BEGIN}{_FILE}value = properties(drake.CalcSpatialInertia(drake.Convex(file.name, scale3=[2.0, 0.5, 4.0]), {DENSITY}))
== moments_turned | RotationalInertia.ReExpress | {_J}J = J.ReExpress(R)\n{_SIX}
== moments_turned:UnitInertia | UnitInertia.ReExpress
{_J}G = drake.UnitInertia(*np.diag(m), m[0, 1], m[0, 2], m[1, 2]).ReExpress(R)
value = [*G.get_moments(), *G.get_products()]
== moments_turned:principal | CalcPrincipalMomentsAndAxesOfInertia
{_J}x, P = J.ReExpress(R).CalcPrincipalMomentsAndAxesOfInertia()
P = P.matrix() @ np.diag(x) @ P.matrix().T
value = [P[0, 0], P[1, 1], P[2, 2], P[0, 1], P[0, 2], P[1, 2]]
== moments_shifted | RotationalInertia.ShiftFromCenterOfMass
{_J}J = J.ReExpress(R).ShiftFromCenterOfMass({MASS}, -v)
{_SIX}
== moments_shifted:sum | RotationalInertia +, UnitInertia.PointMass
{_J}K = drake.UnitInertia.PointMass(v)
J = J.ReExpress(R) + K * {MASS}
{_SIX}
== moments_turned:ShiftToCenterOfMass | RotationalInertia.ShiftToCenterOfMass
{_J}J = J.ReExpress(R).ShiftFromCenterOfMass({MASS}, -v).ShiftToCenterOfMass({MASS}, v)
{_SIX}
== moments_shifted_on | RotationalInertia.ShiftToThenAwayFromCenterOfMass
{_J}J = J.ReExpress(R).ShiftFromCenterOfMass({MASS}, -v).ShiftToThenAwayFromCenterOfMass({MASS}, v, v2)
{_SIX}
== moments_shifted:UnitInertia | UnitInertia.SetFromRotationalInertia, ShiftFromCenterOfMass
{_J}G = drake.UnitInertia().SetFromRotationalInertia(J, {MASS}).ReExpress(R).ShiftFromCenterOfMass(-v)
value = {MASS} * np.r_[G.get_moments(), G.get_products()]
== first_moment | SpatialInertia.CalcComMoment | {_WHOLE}value = I.CalcComMoment()
== moments_traced | RotationalInertia.Trace, CalcMaximumPossibleMomentOfInertia
{_J}value = [J.Trace(), J.CalcMaximumPossibleMomentOfInertia()]
== moments_turned:ellipsoid | CalcPrincipalSemiDiametersAndPoseForSolidEllipsoid
{_WHOLE}lengths, X = I.ReExpress(R).CalcPrincipalSemiDiametersAndPoseForSolidEllipsoid()
P = X.rotation().matrix()
P = {MASS} / 5 * P @ (np.sum(lengths**2) * np.eye(3) - np.diag(lengths**2)) @ P.T
value = [P[0, 0], P[1, 1], P[2, 2], P[0, 1], P[0, 2], P[1, 2]]
""")
