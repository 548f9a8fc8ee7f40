"""CasADi: expressions and their exact derivatives; it has no mechanics, so equations are formed by these derivatives.

Velocities are directional derivatives of poses, accelerations those of velocities, forces follow by the partial
velocities (Kane). What the matrix asks is whether CasADi differentiates, solves and inverts right: a red cell is a
fault of its derivatives, or of this text.
"""

from __future__ import annotations

from ..interface import Convention, Joint, Tree, Unsupported
from .writing.numbering import in_series
from .writing.source import Source, SourcePlugin, Way, series

_SETUP = """import casadi as ca
import numpy as np
# Links: parent, motions (placement R, p; how, axis, place in q, factor, offset), placement after them, m, c, J.
LINKS = {links}
RATES, ARMATURE, gravity = {rates}, {armature}, ca.DM({gravity})
x, w, s, f = (ca.SX.sym(name, n) for name, n in zip("xwsf", ({nq}, {nv}, {nv}, {nv})))
rates = ca.SX.zeros(x.shape[0])
for how, k, j in RATES:
    if how == "line":
        rates[k] = w[j]
    elif how == "circle":
        rates[k:k + 2] = ca.vertcat(-x[k + 1] * w[j], x[k] * w[j])
    else:
        rates[k] = -ca.dot(x[k + 1:k + 4], w[j:j + 3]) / 2
        rates[k + 1:k + 4] = (x[k] * w[j:j + 3] + ca.cross(x[k + 1:k + 4], w[j:j + 3])) / 2
N = ca.jacobian(rates, w)
def rate(e): return ca.jtimes(e, x, rates) + ca.jtimes(e, w, s)
def rotation(K, sine, versine): return ca.SX.eye(3) + sine * K + versine * K @ K
poses, spins, centres, masses = [], [], [], []
M, ID = ca.diag(ca.DM(ARMATURE)), ca.DM(ARMATURE) * s
T, V, momentum = ca.dot(w, M @ w) / 2, 0, ca.SX.zeros(6)
for parent, motions, end, m, c, J in LINKS:
    p, R = poses[parent] if parent >= 0 else (ca.SX.zeros(3), ca.SX.eye(3))
    for R0, p0, how, axis, k, factor, offset in motions:
        p, R, e = p + R @ ca.DM(p0), R @ ca.DM(R0), ca.DM(axis)
        if how == "slide":
            p = p + R @ e * (factor * x[k] + offset)
        elif how == "turn":
            R = R @ rotation(ca.skew(e), ca.sin(factor * x[k] + offset), 1 - ca.cos(factor * x[k] + offset))
        elif how == "circle":
            R = R @ rotation(ca.skew(e), x[k + 1], 1 - x[k])
        else:
            R = R @ rotation(ca.skew(x[k + 1:k + 4]), 2 * x[k], 2)
    p, R = p + R @ ca.DM(end[1]), R @ ca.DM(end[0])
    poses.append((p, R))
    spins.append(ca.inv_skew(ca.reshape(rate(ca.vec(R)), 3, 3) @ R.T))
    centre, J = p + R @ ca.DM(c), R @ ca.DM(J) @ R.T
    speed, spin = rate(centre), spins[-1]
    linear, angular = ca.jacobian(speed, w), ca.jacobian(spin, w)
    M = M + m * linear.T @ linear + angular.T @ J @ angular
    inertial = J @ rate(spin) + ca.cross(spin, J @ spin)
    ID = ID + linear.T @ (m * (rate(speed) - gravity)) + angular.T @ inertial
    T, V = T + (m * ca.dot(speed, speed) + ca.dot(spin, J @ spin)) / 2, V - m * ca.dot(gravity, centre)
    momentum = momentum + ca.vertcat(m * speed, J @ spin + m * ca.cross(centre, speed))
    centres.append(m * centre)
    masses.append(m)
centre = sum(centres) / sum(masses)
momentum = momentum - ca.vertcat(ca.SX.zeros(3), ca.cross(centre, momentum[:3]))
at_rest = ca.SX.zeros(s.shape[0])
bias = ca.substitute(ID, s, at_rest)
weight = ca.substitute(bias, w, at_rest)
FD = ca.solve(M, f - bias)
twists = [ca.vertcat(rate(p), spin) for (p, _), spin in zip(poses, spins)]
def by_q(e): return ca.jacobian(e, x) @ N
def number(e, *given): return np.array(ca.Function("e", [x, w, s, f], [ca.densify(e)])(*given))
"""


def _vector(native: str, expression: str, given: str) -> Way:
    return Way(native, f"value = number({expression}, {given})[:, 0]")


def _matrix(native: str, expression: str, given: str) -> Way:
    return Way(native, f"value = number({expression}, {given})")


_Q, _V, _A, _TAU = "q, 0, 0, 0", "q, v, 0, 0", "q, v, a, 0", "q, v, 0, tau"
WAYS = {
    "mass_matrix": _matrix("jacobian", "M", _Q),
    "mass_matrix:hessian": _matrix("hessian", "ca.hessian(T, w)[0]", _Q),
    "mass_matrix_inverse": _matrix("inv", "ca.inv(M)", _Q),
    "bias": _vector("jtimes", "bias", _V),
    "bias:gradient": _vector(
        "gradient", "ca.substitute(rate(ca.gradient(T, w)) - (ca.gradient(T - V, x).T @ N).T, s, at_rest)", _V
    ),
    "gravity": _vector("gradient", "by_q(V).T", _Q),
    "coriolis_forces": _vector("jtimes", "bias - weight", _V),
    "inverse_dynamics": _vector("jtimes", "ID", _A),
    "forward_dynamics": _vector("solve", "FD", _TAU),
    "kinetic_energy": Way("Function", f"value = number(T, {_V})[0, 0]"),
    "potential_energy": Way("Function", f"value = number(V, {_Q})[0, 0]"),
    "link_poses": Way("Function", f"value = [number(ca.vertcat(p, ca.vec(R.T)), {_Q})[:, 0] for p, R in poses]"),
    "link_velocities": Way("jtimes", f"value = [number(twist, {_V})[:, 0] for twist in twists]"),
    "link_accelerations": Way("jtimes", f"value = [number(rate(twist), {_A})[:, 0] for twist in twists]"),
    "link_velocity_products": Way("jtimes", f"value = [number(rate(twist), {_V})[:, 0] for twist in twists]"),
    "link_jacobians": Way("jacobian", f"value = [number(ca.jacobian(twist, w), {_Q}) for twist in twists]"),
    "link_jacobian_rates": Way(
        "jtimes",
        f"""value = []
for twist in twists:
    J = ca.jacobian(twist, w)
    value.append(number(ca.reshape(rate(ca.vec(J)), *J.shape), {_V}))""",
    ),
    "mass_centre": _vector("Function", "centre", _Q),
    "mass_centre_jacobian": _matrix("jacobian", "by_q(centre)", _Q),
    "mass_centre_velocity_dq": _matrix("jacobian", "by_q(rate(centre))", _V),
    "mass_centre_velocity_products": _vector("jtimes", "rate(rate(centre))", _V),
    "centroidal_matrix": _matrix("jacobian", "ca.jacobian(momentum, w)", _Q),
    "centroidal_momentum": _vector("Function", "momentum", _V),
    "centroidal_momentum_rate": _vector("jtimes", "rate(momentum)", _A),
    "centroidal_momentum_dq": _matrix("jacobian", "by_q(momentum)", _V),
    "centroidal_momentum_rate_dq": _matrix("jacobian", "by_q(rate(momentum))", _A),
    "centroidal_momentum_rate_dv": _matrix("jacobian", "ca.jacobian(rate(momentum), w)", _A),
    "inverse_dynamics_dq": _matrix("jacobian", "by_q(ID)", _A),
    "inverse_dynamics_dv": _matrix("jacobian", "ca.jacobian(ID, w)", _A),
    "mass_matrix_dq": Way("jacobian", f"value = number(by_q(ca.vec(M.T)), {_Q}).reshape(len(v), len(v), len(v))"),
    "link_poses_dq": Way("jacobian", f"value = [number(by_q(ca.vertcat(p, ca.vec(R.T))), {_Q}) for p, R in poses]"),
    "gravity_dq": _matrix("jacobian", "by_q(weight)", _Q),
    "forward_dynamics_dq": _matrix("jacobian of solve", "by_q(FD)", _TAU),
    "forward_dynamics_dv": _matrix("jacobian of solve", "ca.jacobian(FD, w)", _TAU),
}

_CHARTS = {
    ("revolute", ""): "angle",
    ("revolute", "unbounded"): "cos sin",
    ("prismatic", ""): "length",
    ("helical", ""): "screw angle",
    ("universal", ""): "two angles",
    ("euler", ""): "three angles",
    ("translation", ""): "three lengths",
    ("planar", ""): "planar angle",
    ("ball", ""): "quaternion wxyz, body speeds",
    ("free", ""): "free wxyz, linear before and angular after",
}
_AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}
_SLIDES = [("slide", axis) for axis in _AXES.values()]
_EYE, _ZERO = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]


def _motions(joint: Joint) -> list[tuple[str, tuple[float, float, float]]]:
    """Motions in series, each by the next coordinates."""
    if joint.kind == "revolute":
        return [("circle" if joint.form else "turn", joint.axis)]
    if joint.kind == "euler":
        return [("turn", _AXES[letter]) for letter in joint.sequence]
    return {
        "prismatic": [("slide", joint.axis)],
        "universal": [("turn", joint.axis), ("turn", joint.second)],
        "translation": _SLIDES,
        "planar": [*_SLIDES[:2], ("turn", _AXES["Z"])],
        "ball": [("quaternion", _AXES["Z"])],
        "free": [*_SLIDES, ("quaternion", _AXES["Z"])],
    }[joint.kind]


def _placed(joint: Joint, place: int) -> list[tuple[str, tuple[float, float, float], int, float, float]]:
    """Motions with their places in q, factors and offsets."""
    if joint.kind == "helical":
        pitch, ratio, offset = joint.pitch, joint.ratio, joint.offset
        return [
            ("slide", joint.axis, place, pitch * ratio, pitch * offset),
            ("turn", joint.axis, place, ratio, offset),
        ]
    return [(how, axis, place + i, joint.ratio, joint.offset) for i, (how, axis) in enumerate(_motions(joint))]


def write(tree: Tree) -> Source | Unsupported:
    """A tree as data of the text above."""
    for joint in (joint for link in tree.links for joint in link.joints):
        if joint.kind != "fixed" and (joint.kind, joint.form) not in _CHARTS:
            return Unsupported(
                f'no expressions are stated for a joint of kind "{joint.kind} {joint.form}"', offered=False
            )
    slots, nq, nv = in_series(tree, _CHARTS)
    links: list[tuple[object, ...]] = []
    rates: list[tuple[str, int, int]] = []
    armature = [0.0] * nv
    for link, own in zip(tree.links, slots, strict=True):
        steps, (R_end, p_end) = series(link.joints)
        motions: list[tuple[object, ...]] = []
        for (R, p, joint), slot in zip(steps, own, strict=True):
            first = [R.tolist(), p.tolist()]
            for motion in _placed(joint, slot.q[0]):
                motions.append((*first, *motion))
                first = [_EYE, _ZERO]
            if joint.mimics:
                continue
            for j, inertia in zip(slot.v, joint.armature, strict=False):
                armature[j] += inertia
            q, v = slot.q[0], slot.v[0]
            for how, _ in [("line", ())] if joint.kind == "helical" else _motions(joint):
                rates.append((how if how in ("circle", "quaternion") else "line", q, v))
                q, v = q + 1, v + 1
        links.append((link.parent, motions, (R_end.tolist(), p_end.tolist()), link.mass, list(link.com), link.inertia))
    setup = _SETUP.format(links=links, rates=rates, armature=armature, gravity=list(tree.gravity), nq=nq, nv=nv)
    # Lagrange's equations are those of speeds that are rates of coordinates.
    lacks = ("bias:gradient",) if any(how == "quaternion" for how, *_ in rates) else ()
    return Source((setup,), slots, nq, nv, lacks=lacks)


PLUGIN = SourcePlugin(
    name="casadi",
    package="casadi",
    extra="symofros[validation]",
    conventions=(
        Convention("mechanics", "none of its own: equations by its derivatives, with the coordinates of the tree"),
        Convention("derivatives", "by coordinates of any kind; along speeds by the chain rule"),
        Convention("quaternion", "none; here scalar first, of unit length"),
        Convention("solving", "solve and inv of SX expand into a factorisation without pivots"),
    ),
    kinds=dict.fromkeys(
        (
            *("revolute x", "revolute y", "revolute z", "revolute oblique", "revolute unbounded"),
            *("revolute unbounded oblique", "prismatic", "prismatic oblique", "helical", "helical oblique"),
            *("universal", "euler zyx", "euler xyz", "translation", "planar", "ball", "free", "free between links"),
            *("mimic revolute", "mimic oblique", "mimic prismatic"),
        ),
        "an expression",
    ),
    ways=WAYS,
    write=write,
    calls=2,
)
