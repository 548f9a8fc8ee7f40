"""Spatial Maths for Python: rotations, their vectors and angles; no mechanics."""

from __future__ import annotations

from ..interface import Convention, Slot, Statement, Tree, Unsupported
from ..truth.geometry.poses import CENTRE, MASS, MOMENTS
from .writing.source import HALF_TURNS, ON_END, Source, SourcePlugin, Way

_R = "R, Q = sm.q2r(q), sm.q2r(q2)\n"
_HALF = "u = v + np.array([4.0, -8.0, 8.0])\nH = 2 * np.outer(u, u) / (u @ u) - np.eye(3)\n"
WAYS = {
    "rotation_matrix": Way("q2r", "value = sm.q2r(q).ravel()"),
    "rotation_composed": Way("qqmul", "value = sm.q2r(sm.qqmul(q, q2)).ravel()"),
    "rotation_angle": Way("qangle", "value = [sm.qangle(q, q2 if q @ q2 > 0 else -q2)]"),
    "rotation_logarithm": Way("trlog", f"{_R}value = sm.trlog(R, twist=True)"),
    "rotation_logarithm:tr2angvec": Way("tr2angvec", f"{_R}angle, axis = sm.tr2angvec(R)\nvalue = angle * axis"),
    "rotation_exponential": Way("trexp", "value = sm.trexp(v).ravel()"),
    "rotation_exponential:angvec2r": Way(
        "angvec2r", "angle = np.linalg.norm(v)\nvalue = (sm.angvec2r(angle, v) if angle else np.eye(3)).ravel()"
    ),
    "rotation_exponential_of_turns": Way("trexp", "value = sm.trexp(16 * v).ravel()"),
    "rotation_half_turn": Way("r2q", f"{_HALF}value = sm.q2r(sm.r2q(H)).ravel()"),
    "rotation_half_turns": Way("r2q", f"{HALF_TURNS}value = [sm.q2r(sm.r2q(H)).ravel() for H in half_turns]"),
    "rotation_vector_rates_fixed": Way("rotvelxform", "value = sm.rotvelxform(v, inverse=True, representation='exp')"),
    "rotation_vector_rates_fixed:exp2jac": Way("exp2jac", "value = np.linalg.inv(sm.exp2jac(v))"),
    "rotation_vector_rates_rate": Way(
        "rotvelxform_inv_dot", "value = sm.rotvelxform_inv_dot(tau, a, representation='exp')"
    ),
    "rpy_rates": Way("rotvelxform", "value = sm.rotvelxform(v, inverse=True, representation='rpy/zyx')"),
    "rpy_rates:rpy2jac": Way("rpy2jac", "value = np.linalg.inv(sm.rpy2jac(v, order='zyx'))"),
    "rpy_rates_rate": Way("rotvelxform_inv_dot", "value = sm.rotvelxform_inv_dot(v, a, representation='rpy/zyx')"),
    "rotation_halfway": Way("qslerp", "value = sm.q2r(sm.qslerp(q, q2, 0.25, shortest=True)).ravel()"),
    "rotation_halfway:trinterp": Way("trinterp", f"{_R}value = sm.trinterp(R, Q, 0.25).ravel()"),
    "twist_transform": Way("tr2adjoint", "value = sm.tr2adjoint(sm.rt2tr(sm.q2r(q), a))"),
}
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


WAYS |= {
    "pose_composed": Way("SE3 * SE3", f"{_X}{_flat('(X * Y).A')}"),
    "pose_unset": Way("SE3", f"import spatialmath as cls\n{_flat('cls.SE3().A')}"),
    "pose_inverse": Way("SE3.inv", f"{_X}{_flat('X.inv().A')}"),
    "pose_inverse:trinv": Way("trinv", f"{_T}{_flat('sm.trinv(T)')}"),
    "pose_relative": Way("SE3 / SE3", f"{_X}{_flat('(X.inv() / Y.inv()).A')}"),
    "pose_of_point": Way("SE3 * point", f"{_X}value = np.ravel(X * v)"),
    "pose_of_point:homtrans": Way("homtrans", f"{_T}value = np.ravel(sm.homtrans(T, v))"),
    "pose_logarithm": Way("trlog", f"{_T}value = sm.trlog(T, twist=True)"),
    "pose_logarithm:Twist3": Way("Twist3", f"{_X}value = cls.Twist3(X).A"),
    "pose_difference": Way("trlog", f"{_T}value = sm.trlog(sm.trinv(T) @ U, twist=True)"),
    "pose_exponential": Way("trexp", f"T = sm.trexp(np.r_[v, v2])\n{_flat('T')}"),
    "pose_exponential:Twist3": Way(
        "Twist3.exp", f"import spatialmath as cls\nT = cls.Twist3(np.r_[v, v2]).exp(1).A\n{_flat('T')}"
    ),
    "pose_exponential:UnitTwist": Way(
        "trexp of a unit twist",
        f"turn = np.linalg.norm(v2)\nT = sm.trexp(np.r_[v, v2] / turn, turn) if turn else sm.transl(v)\n{_flat('T')}",
    ),
    "pose_halfway_apart": Way("trinterp", f"{_T}{_flat('sm.trinterp(T, U, 0.25)')}"),
    "pose_halfway_apart:SE3": Way("SE3.interp", f"{_X}{_flat('X.interp(Y, 0.25).A')}"),
    "wrench_transform": Way("SE3.Ad, its inverse's transpose", f"{_X}value = X.inv().Ad().T"),
    "twist_transform:SE3": Way("SE3.Ad", f"{_X}value = X.Ad()"),
    "twist_transform:Twist3": Way("Twist3.Ad", f"{_X}value = cls.Twist3(X).Ad()"),
    "twist_transform_back": Way("Ad of the inverse", f"{_X}value = X.inv().Ad()"),
    "twist_transform:SpatialVelocity": Way(
        "SE3 * SpatialVelocity", f"{_X}value = np.stack([(X * cls.SpatialVelocity(e)).A for e in np.eye(6)], axis=1)"
    ),
    "wrench_transform:SpatialForce": Way(
        "SE3 * SpatialForce", f"{_X}value = np.stack([(X * cls.SpatialForce(e)).A for e in np.eye(6)], axis=1)"
    ),
    "pose_composed:UnitDualQuaternion": Way(
        "UnitDualQuaternion",
        f"{_X}D = cls.UnitDualQuaternion(X) * cls.UnitDualQuaternion(Y)\n"
        f"Z = cls.UnitDualQuaternion(D.real, D.dual).SE3().A\n{_flat('Z')}",
    ),
    "twist_cross": Way("Twist3.ad", "import spatialmath as cls\nvalue = cls.Twist3(np.r_[v, v2]).ad()"),
    "quaternion_rates": Way("qdotb", "value = sm.qdotb(q, v)"),
    "quaternion_rates:UnitQuaternion": Way("UnitQuaternion.dotb", f"{_SIGNED}value = Q.dotb(v) * sign"),
    "quaternion_rates_fixed": Way("qdot", "value = sm.qdot(q, v)"),
    "quaternion_rates_fixed:UnitQuaternion": Way("UnitQuaternion.dot", f"{_SIGNED}value = Q.dot(v) * sign"),
    "rotation_of_rpy": Way("rpy2r", "value = sm.rpy2r(v).ravel()"),
    "rotation_of_rpy:UnitQuaternion": Way(
        "UnitQuaternion.RPY", "import spatialmath as cls\nvalue = cls.UnitQuaternion.RPY(v).R.ravel()"
    ),
    "rotations_on_end": Way("tr2rpy", f"{ON_END}value = [sm.rpy2r(sm.tr2rpy(H)).ravel() for H in on_end]"),
    "rotation_to_rpy": Way("tr2rpy", "value = sm.tr2rpy(sm.q2r(q))"),
    "rotation_to_rpy:UnitQuaternion": Way(
        "UnitQuaternion.rpy", "import spatialmath as cls\nvalue = np.ravel(cls.UnitQuaternion(q).rpy())"
    ),
    "rotation_of_zyz": Way("eul2r", "value = sm.eul2r(v).ravel()"),
    "rotation_of_zyz:tr2eul": Way("tr2eul", "value = sm.eul2r(sm.tr2eul(sm.eul2r(v))).ravel()"),
    "zyz_speeds": Way("eul2jac", "value = sm.eul2jac(v)"),
    "zyz_speeds:rotvelxform": Way("rotvelxform", "value = sm.rotvelxform(v, representation='eul')"),
    "rotation_composed:UnitQuaternion": Way(
        "UnitQuaternion * UnitQuaternion",
        "import spatialmath as cls\nvalue = (cls.UnitQuaternion(q) * cls.UnitQuaternion(q2)).R.ravel()",
    ),
    "rotation_angle:SO3": Way(
        "SO3.angdist", f"import spatialmath as cls\n{_R}value = [cls.SO3(R).angdist(cls.SO3(Q), metric=6)]"
    ),
    "rotation_halfway:UnitQuaternion": Way(
        "UnitQuaternion.interp",
        "import spatialmath as cls\n"
        "value = cls.UnitQuaternion(q).interp(cls.UnitQuaternion(q2), 0.25, shortest=True).R.ravel()",
    ),
    "are_rotations": Way("isR", f"{_R}F = R * [1, 1, -1]\nvalue = [float(sm.isR(A)) for A in (R, F, 1.25 * R)]"),
    "cross_matrix": Way("skew", "value = sm.skew(v)"),
    "cross_matrix:vex": Way("vex", "value = np.cross(np.eye(3), sm.vex(sm.skew(v)))"),
    "turned_vector": Way("qvmul", "value = sm.qvmul(q, v)"),
    "turned_vector:SO3": Way("SO3 * vector", f"import spatialmath as cls\n{_R}value = np.ravel(cls.SO3(R) * v)"),
    "turned_vector:UnitQuaternion": Way(
        "UnitQuaternion * vector", "import spatialmath as cls\nvalue = np.ravel(cls.UnitQuaternion(q) * v)"
    ),
    "rotation_inverse": Way("qconj", "value = sm.q2r(sm.qconj(q)).ravel()"),
    "rotation_inverse:SO3": Way("SO3.inv", f"import spatialmath as cls\n{_R}value = cls.SO3(R).inv().A.ravel()"),
    "rotation_inverse:UnitQuaternion": Way(
        "UnitQuaternion.inv", "import spatialmath as cls\nvalue = cls.UnitQuaternion(q).inv().R.ravel()"
    ),
    "rotation_integrated": Way("trexp", f"{_R}value = (R @ sm.trexp(v)).ravel()"),
    "wrench_transform_back": Way("SE3.Ad, transposed", f"{_X}value = X.Ad().T"),
    "pose_integrated": Way("SE3 * Twist3.exp", f"{_X}{_flat('(X * cls.Twist3(np.r_[v, v2]).exp()).A')}"),
    "wrench_cross:SpatialVelocity": Way(
        "SpatialVelocity.cross of forces",
        f"import spatialmath as cls\n{_TWIST}"
        "value = np.stack([V.cross(cls.SpatialForce(e)).A for e in np.eye(6)], axis=1)",
    ),
    "twist_about_line": Way(
        "Twist3.UnitRevolute",
        f"import spatialmath as cls\n{_AXES}S = cls.Twist3.UnitRevolute((v + away) / np.linalg.norm(v + away), a)\n"
        "value = S.S",
    ),
    "turn_about_line": Way(
        "Twist3.UnitRevolute.exp",
        f"import spatialmath as cls\n{_AXES}S = cls.Twist3.UnitRevolute((v + away) / np.linalg.norm(v + away), a)\n"
        f"{_flat('S.exp(tau[0]).A')}",
    ),
    "rotation_of_two_axes": Way("oa2r", f"{_AXES}value = sm.oa2r(v2 + aside, v + away).ravel()"),
    "line": Way("Line3.PointDir", f"{_LINE}{_MOMENT.format(of='L')}"),
    "line:Join": Way("Line3.Join", f"{_LINE}L = cls.Line3.Join(a + unit(v + away), a)\n{_MOMENT.format(of='L')}"),
    "line:PointDir": Way(
        "Line3.PointDir, of any length", f"{_LINE}L = cls.Line3.PointDir(a, v + away)\n{_MOMENT.format(of='L')}"
    ),
    "lines_apart:PointDir": Way(
        "Line3.distance, of any length", f"{_LINE}value = [cls.Line3.PointDir(a, 2 * L.w).distance(M)]"
    ),
    "line_placed": Way("SE3 * Line3", f"{_X}{_LINE}L = Y * L\n{_MOMENT.format(of='L')}"),
    "line_nearest": Way("Line3.closest_to_point", f"{_LINE}value = L.closest_to_point(tau)[0]"),
    "line_nearest_to_origin": Way("Line3.pp", f"{_LINE}value = L.pp"),
    "lines_apart": Way("Line3.distance", f"{_LINE}value = [L.distance(M)]"),
    "lines_apart:closest_to_line": Way("Line3.closest_to_line", f"{_LINE}value = [L.closest_to_line(M)[1]]"),
    "lines_perpendicular": Way("Line3.commonperp", f"{_LINE}N = L.commonperp(M)\n{_MOMENT.format(of='N')}"),
    "line_of_plane": Way(
        "Line3.intersect_plane",
        f"{_LINE}value = L.intersect_plane(cls.Plane3.PointNormal(tau, v2 + beside)).p",
    ),
    "line_of_planes": Way("Line3.TwoPlanes", f"{_PLANES}L = cls.Line3.TwoPlanes(A, B)\n{_MOMENT.format(of='L')}"),
    "planes_meet": Way("Plane3.intersection", f"{_PLANES}value = cls.Plane3.intersection(A, B, C)"),
    "plane_of_points": Way(
        "Plane3.ThreePoints",
        f"{_LINE}P = cls.Plane3.ThreePoints(np.stack([a, a + v + away, tau], axis=1))\n{_DISTANCE}",
    ),
    "plane_of_points:LinePoint": Way("Plane3.LinePoint", f"{_LINE}P = cls.Plane3.LinePoint(L, tau)\n{_DISTANCE}"),
    "plane_of_lines": Way("Plane3.TwoLines", f"{_LINE}P = cls.Plane3.TwoLines(L, M)\n{_DISTANCE}"),
    "screw_pitch": Way("Twist3.pitch", f"{_SCREW}value = [{_CALLED.format(of='S.pitch')}]"),
    "screw_line": Way("Twist3.line", f"{_SCREW}L = S.line()\n{_MOMENT.format(of='L')}"),
    "screw_pole": Way("Twist3.pole", f"{_SCREW}value = {_CALLED.format(of='S.pole')}"),
    "screw_of_line": Way(
        "Twist3.UnitRevolute",
        f"import spatialmath as cls\n{_AXES}value = cls.Twist3.UnitRevolute(v + away, a, 0.375).A",
    ),
    "spatial_inertia": Way("SpatialInertia", f"{_BODY}value = I.A"),
    "spatial_inertia_sum": Way(
        "SpatialInertia + SpatialInertia",
        f"{_X}{_BODY}value = (I + cls.SpatialInertia(X.inv().Ad().T @ I.A @ X.inv().Ad())).A",
    ),
    "spatial_momentum": Way("SpatialInertia * SpatialVelocity", f"{_BODY}{_TWIST}value = (I * V).A"),
    "spatial_momentum_cross": Way("SpatialVelocity @ SpatialMomentum", f"{_BODY}{_TWIST}value = (V @ (I * V)).A"),
}


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
            lambda tree, text: tree.near > 20,
        ),
    ),
)
