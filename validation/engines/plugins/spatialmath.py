"""Spatial Maths for Python: rotations, their vectors and angles; no mechanics."""

from __future__ import annotations

from ..interface import Convention, Slot, Statement, Tree, Unsupported
from ..truth.geometry.poses import CENTRE, MASS, MOMENTS
from .writing.source import HALF_TURNS, ON_END, Source, SourcePlugin, ways_of

_R = "R, Q = sm.q2r(q), sm.q2r(q2)\n"
_HALF = "u = v + np.array([4.0, -8.0, 8.0])\nH = 2 * np.outer(u, u) / (u @ u) - np.eye(3)\n"
WAYS = ways_of(f"""
== rotation_matrix | q2r | value = sm.q2r(q).ravel()
== rotation_composed | qqmul | value = sm.q2r(sm.qqmul(q, q2)).ravel()
== rotation_angle | qangle | value = [sm.qangle(q, q2 if q @ q2 > 0 else -q2)]
== rotation_logarithm | trlog | {_R}value = sm.trlog(R, twist=True)
== rotation_logarithm:tr2angvec | tr2angvec | {_R}angle, axis = sm.tr2angvec(R)\nvalue = angle * axis
== rotation_exponential | trexp | value = sm.trexp(v).ravel()
== rotation_exponential:angvec2r | angvec2r
angle = np.linalg.norm(v)
value = (sm.angvec2r(angle, v) if angle else np.eye(3)).ravel()
== rotation_exponential_of_turns | trexp | value = sm.trexp(16 * v).ravel()
== rotation_half_turn | r2q | {_HALF}value = sm.q2r(sm.r2q(H)).ravel()
== rotation_half_turns | r2q | {HALF_TURNS}value = [sm.q2r(sm.r2q(H)).ravel() for H in half_turns]
== rotation_vector_rates_fixed | rotvelxform | value = sm.rotvelxform(v, inverse=True, representation='exp')
== rotation_vector_rates_fixed:exp2jac | exp2jac | value = np.linalg.inv(sm.exp2jac(v))
== rotation_vector_rates_rate | rotvelxform_inv_dot | value = sm.rotvelxform_inv_dot(tau, a, representation='exp')
== rpy_rates | rotvelxform | value = sm.rotvelxform(v, inverse=True, representation='rpy/zyx')
== rpy_rates:rpy2jac | rpy2jac | value = np.linalg.inv(sm.rpy2jac(v, order='zyx'))
== rpy_rates_rate | rotvelxform_inv_dot | value = sm.rotvelxform_inv_dot(v, a, representation='rpy/zyx')
== rotation_halfway | qslerp | value = sm.q2r(sm.qslerp(q, q2, 0.25, shortest=True)).ravel()
== rotation_halfway:trinterp | trinterp | {_R}value = sm.trinterp(R, Q, 0.25).ravel()
== twist_transform | tr2adjoint | value = sm.tr2adjoint(sm.rt2tr(sm.q2r(q), a))
""")
# Placements are arrays of its functions (T, U) or objects of its classes (X, Y).
_T = "T, U = sm.rt2tr(sm.q2r(q), a), sm.rt2tr(sm.q2r(q2), tau)\n"
_X = f"import spatialmath as cls\n{_T}X, Y = cls.SE3(T), cls.SE3(U)\n"
_FLAT = "value = [*{of}[:3, 3], *{of}[:3, :3].flat]"
_AXES = "away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))\n"
# Its moments are d cross x. Of long directions it takes the roundings for moments along them, and refuses.
_UNITS = f"import spatialmath as cls\n{_AXES}def unit(x): return x / np.linalg.norm(x)\n"
_LINE = f"{_UNITS}L, M = cls.Line3.PointDir(a, unit(v + away)), cls.Line3.PointDir(tau, unit(v2 + aside))\n"
_MOMENT = "value = np.r_[-{of}.v, {of}.w] / np.linalg.norm({of}.w)"
_PLANES = (
    f"{_UNITS}A, B, C = (cls.Plane3.PointNormal(x, unit(n)) for x, n in ((a, away), (tau, aside), (v2, beside)))\n"
)
# Its class keeps the one of q and -q with the scalar that is not negative.
_SIGNED = "import spatialmath as cls\nQ = cls.UnitQuaternion(q)\nsign = np.sign(Q.vec @ q)\n"
_DISTANCE = "value = [abs(P.d) / np.linalg.norm(P.n)]"
_SCREW = f"import spatialmath as cls\n{_AXES}S = cls.Twist3(a, v + away)\n"
_CALLED = "{of}() if callable({of}) else {of}"
_BODY = (
    f"import spatialmath as cls\nI = cls.SpatialInertia({MASS}, {list(CENTRE)}, np.array({[*map(list, MOMENTS)]}))\n"
)
_TWIST = "V = cls.SpatialVelocity(np.r_[v, v2])\n"


def _flat(of: str) -> str:
    return _FLAT.format(of=of)


WAYS |= ways_of(f"""
== pose_composed | SE3 * SE3 | {_X}{_flat("(X * Y).A")}
== pose_unset | SE3 | import spatialmath as cls\n{_flat("cls.SE3().A")}
== pose_drawn | SE3.Rand
import spatialmath as cls
value = np.ravel(cls.SE3.Rand(xrange=(v[0], v[0]), yrange=(v[1], v[1]), zrange=(v[2], v[2])).t)
== pose_inverse | SE3.inv | {_X}{_flat("X.inv().A")}
== pose_inverse:trinv | trinv | {_T}{_flat("sm.trinv(T)")}
== pose_relative | SE3 / SE3 | {_X}{_flat("(X.inv() / Y.inv()).A")}
== pose_of_point | SE3 * point | {_X}value = np.ravel(X * v)
== pose_of_point:homtrans | homtrans | {_T}value = np.ravel(sm.homtrans(T, v))
== pose_logarithm | trlog | {_T}value = sm.trlog(T, twist=True)
== pose_logarithm:Twist3 | Twist3 | {_X}value = cls.Twist3(X).A
== pose_difference | trlog | {_T}value = sm.trlog(sm.trinv(T) @ U, twist=True)
== pose_exponential | trexp | T = sm.trexp(np.r_[v, v2])\n{_flat("T")}
== pose_exponential:Twist3 | Twist3.exp | import spatialmath as cls\nT = cls.Twist3(np.r_[v, v2]).exp(1).A\n{_flat("T")}
== pose_exponential:UnitTwist | trexp of a unit twist
turn = np.linalg.norm(v2)
T = sm.trexp(np.r_[v, v2] / turn, turn) if turn else sm.transl(v)
{_flat("T")}
== pose_halfway_apart | trinterp | {_T}{_flat("sm.trinterp(T, U, 0.25)")}
== pose_halfway_apart:SE3 | SE3.interp | {_X}{_flat("X.interp(Y, 0.25).A")}
== wrench_transform | SE3.Ad, its inverse's transpose | {_X}value = X.inv().Ad().T
== twist_transform:SE3 | SE3.Ad | {_X}value = X.Ad()
== twist_transform:Twist3 | Twist3.Ad | {_X}value = cls.Twist3(X).Ad()
== twist_transform_back | Ad of the inverse | {_X}value = X.inv().Ad()
== twist_transform:SpatialVelocity | SE3 * SpatialVelocity
{_X}value = np.stack([(X * cls.SpatialVelocity(e)).A for e in np.eye(6)], axis=1)
== wrench_transform:SpatialForce | SE3 * SpatialForce
{_X}value = np.stack([(X * cls.SpatialForce(e)).A for e in np.eye(6)], axis=1)
== pose_composed:UnitDualQuaternion | UnitDualQuaternion
{_X}D = cls.UnitDualQuaternion(X) * cls.UnitDualQuaternion(Y)
Z = cls.UnitDualQuaternion(D.real, D.dual).SE3().A
{_flat("Z")}
== twist_cross | Twist3.ad | import spatialmath as cls\nvalue = cls.Twist3(np.r_[v, v2]).ad()
== quaternion_rates | qdotb | value = sm.qdotb(q, v)
== quaternion_rates:UnitQuaternion | UnitQuaternion.dotb | {_SIGNED}value = Q.dotb(v) * sign
== quaternion_rates_fixed | qdot | value = sm.qdot(q, v)
== quaternion_rates_fixed:UnitQuaternion | UnitQuaternion.dot | {_SIGNED}value = Q.dot(v) * sign
== rotation_of_rpy | rpy2r | value = sm.rpy2r(v).ravel()
== rotation_of_rpy:UnitQuaternion | UnitQuaternion.RPY
import spatialmath as cls
value = cls.UnitQuaternion.RPY(v).R.ravel()
== rotations_on_end | tr2rpy | {ON_END}value = [sm.rpy2r(sm.tr2rpy(H)).ravel() for H in on_end]
== rotation_to_rpy | tr2rpy | value = sm.tr2rpy(sm.q2r(q))
== rotation_to_rpy:UnitQuaternion | UnitQuaternion.rpy
import spatialmath as cls
value = np.ravel(cls.UnitQuaternion(q).rpy())
== rotation_of_zyz | eul2r | value = sm.eul2r(v).ravel()
== rotation_of_zyz:tr2eul | tr2eul | value = sm.eul2r(sm.tr2eul(sm.eul2r(v))).ravel()
== zyz_speeds | eul2jac | value = sm.eul2jac(v)
== zyz_speeds:rotvelxform | rotvelxform | value = sm.rotvelxform(v, representation='eul')
== rotation_composed:UnitQuaternion | UnitQuaternion * UnitQuaternion
import spatialmath as cls
value = (cls.UnitQuaternion(q) * cls.UnitQuaternion(q2)).R.ravel()
== rotation_angle:SO3 | SO3.angdist | import spatialmath as cls\n{_R}value = [cls.SO3(R).angdist(cls.SO3(Q), metric=6)]
== rotation_halfway:UnitQuaternion | UnitQuaternion.interp
import spatialmath as cls
value = cls.UnitQuaternion(q).interp(cls.UnitQuaternion(q2), 0.25, shortest=True).R.ravel()
== are_rotations | isR | {_R}F = R * [1, 1, -1]\nvalue = [float(sm.isR(A)) for A in (R, F, 1.25 * R)]
== cross_matrix | skew | value = sm.skew(v)
== cross_matrix:vex | vex | value = np.cross(np.eye(3), sm.vex(sm.skew(v)))
== turned_vector | qvmul | value = sm.qvmul(q, v)
== turned_vector:SO3 | SO3 * vector | import spatialmath as cls\n{_R}value = np.ravel(cls.SO3(R) * v)
== turned_vector:UnitQuaternion | UnitQuaternion * vector
import spatialmath as cls
value = np.ravel(cls.UnitQuaternion(q) * v)
== rotation_inverse | qconj | value = sm.q2r(sm.qconj(q)).ravel()
== rotation_inverse:SO3 | SO3.inv | import spatialmath as cls\n{_R}value = cls.SO3(R).inv().A.ravel()
== rotation_inverse:UnitQuaternion | UnitQuaternion.inv
import spatialmath as cls
value = cls.UnitQuaternion(q).inv().R.ravel()
== rotation_integrated | trexp | {_R}value = (R @ sm.trexp(v)).ravel()
== wrench_transform_back | SE3.Ad, transposed | {_X}value = X.Ad().T
== pose_integrated | SE3 * Twist3.exp | {_X}{_flat("(X * cls.Twist3(np.r_[v, v2]).exp()).A")}
== wrench_cross:SpatialVelocity | SpatialVelocity.cross of forces
import spatialmath as cls
{_TWIST}value = np.stack([V.cross(cls.SpatialForce(e)).A for e in np.eye(6)], axis=1)
== twist_about_line | Twist3.UnitRevolute
import spatialmath as cls
{_AXES}S = cls.Twist3.UnitRevolute((v + away) / np.linalg.norm(v + away), a)
value = S.S
== turn_about_line | Twist3.UnitRevolute.exp
import spatialmath as cls
{_AXES}S = cls.Twist3.UnitRevolute((v + away) / np.linalg.norm(v + away), a)
{_flat("S.exp(tau[0]).A")}
== rotation_of_two_axes | oa2r | {_AXES}value = sm.oa2r(v2 + aside, v + away).ravel()
== line | Line3.PointDir | {_LINE}{_MOMENT.format(of="L")}
== line:Join | Line3.Join | {_LINE}L = cls.Line3.Join(a + unit(v + away), a)\n{_MOMENT.format(of="L")}
== line:PointDir | Line3.PointDir, of any length | {_LINE}L = cls.Line3.PointDir(a, v + away)\n{_MOMENT.format(of="L")}
== lines_apart:PointDir | Line3.distance, of any length | {_LINE}value = [cls.Line3.PointDir(a, 2 * L.w).distance(M)]
== line_placed | SE3 * Line3 | {_X}{_LINE}L = Y * L\n{_MOMENT.format(of="L")}
== line_nearest | Line3.closest_to_point | {_LINE}value = L.closest_to_point(tau)[0]
== line_nearest_to_origin | Line3.pp | {_LINE}value = L.pp
== lines_apart | Line3.distance | {_LINE}value = [L.distance(M)]
== lines_apart:closest_to_line | Line3.closest_to_line | {_LINE}value = [L.closest_to_line(M)[1]]
== lines_perpendicular | Line3.commonperp | {_LINE}N = L.commonperp(M)\n{_MOMENT.format(of="N")}
== line_of_plane | Line3.intersect_plane | {_LINE}value = L.intersect_plane(cls.Plane3.PointNormal(tau, v2 + beside)).p
== line_of_planes | Line3.TwoPlanes | {_PLANES}L = cls.Line3.TwoPlanes(A, B)\n{_MOMENT.format(of="L")}
== planes_meet | Plane3.intersection | {_PLANES}value = cls.Plane3.intersection(A, B, C)
== plane_of_points | Plane3.ThreePoints
{_LINE}P = cls.Plane3.ThreePoints(np.stack([a, a + v + away, tau], axis=1))
{_DISTANCE}
== plane_of_points:LinePoint | Plane3.LinePoint | {_LINE}P = cls.Plane3.LinePoint(L, tau)\n{_DISTANCE}
== plane_of_lines | Plane3.TwoLines | {_LINE}P = cls.Plane3.TwoLines(L, M)\n{_DISTANCE}
== screw_pitch | Twist3.pitch | {_SCREW}value = [{_CALLED.format(of="S.pitch")}]
== screw_unit | Twist3.unit | {_SCREW}value = S.unit().S
== screw_unit_sliding | Twist3.unit | {_SCREW}value = cls.Twist3(v + away, 0 * v).unit().S
== screw_line | Twist3.line | {_SCREW}L = S.line()\n{_MOMENT.format(of="L")}
== screw_pole | Twist3.pole | {_SCREW}value = {_CALLED.format(of="S.pole")}
== screw_of_line | Twist3.UnitRevolute
import spatialmath as cls
{_AXES}value = cls.Twist3.UnitRevolute(v + away, a, 0.375).A
== spatial_inertia | SpatialInertia | {_BODY}value = I.A
== spatial_inertia_sum | SpatialInertia + SpatialInertia
{_X}{_BODY}value = (I + cls.SpatialInertia(X.inv().Ad().T @ I.A @ X.inv().Ad())).A
== spatial_momentum | SpatialInertia * SpatialVelocity | {_BODY}{_TWIST}value = (I * V).A
== spatial_momentum_cross | SpatialVelocity @ SpatialMomentum | {_BODY}{_TWIST}value = (V @ (I * V)).A
""")


def write(tree: Tree) -> Source | Unsupported:
    """Text that imports it: a turn is a quaternion."""
    if tree.asked != "turns":
        return Unsupported("no mechanics", offered=False)
    slots = ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),)
    return Source(("import numpy as np", "import spatialmath.base as sm"), slots, 4, 3)


PLUGIN = SourcePlugin(
    name="spatialmath",
    package="spatialmath-python",
    extra="spatialmath-python",
    conventions=(
        Convention("quaternion", "w, x, y, z"),
        Convention("angular velocity", "along the axes before the turn"),
        Convention("roll, pitch, yaw", "R = Rz Ry Rx with order='zyx'"),
    ),
    kinds={},
    ways=WAYS,
    write=write,
    demands={"turns": "rotations as quaternions and matrices"},
    statements=(
        Statement(
            "precondition",
            "a matrix whose trace is 3 but for 20 roundings turns by nothing, that is by less than some 1e-7",
            'spatialmath 1.1.18, trlog: "tol: Tolerance in units of eps for zero-rotation case, defaults to 20"',
            "rotation_logarithm.*|rotation_angle:SO3|pose_logarithm.*|pose_difference|twist_transform:Twist3",
            lambda tree, text: tree.near > 20 and not tree.beside.startswith("half turns"),
        ),
    ),
)
