"""Spatial Maths for Python: rotations, their vectors and angles; no mechanics."""

from __future__ import annotations

from ..interface import Convention, Slot, Statement, Tree, Unsupported
from .writing.source import HALF_TURNS, Source, SourcePlugin, Way

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
            "rotation_logarithm.*",
            lambda tree, text: tree.near > 20,
        ),
    ),
)
