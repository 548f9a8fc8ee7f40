# casadi 3.8.2, chain 43: free base, oblique gravity, 0: free between links, 0: fixed beyond, 0: at the origin: jacobian of solve is imprecise (derivative of forward dynamics by v).
# Known: https://github.com/casadi/casadi/issues/2571 (that MX takes Householder's reflections and SX does not).
import casadi as ca
import numpy as np
# Links: parent, motions (placement R, p; how, axis, place in q, factor, offset), placement after them, m, c, J.
LINKS = [(-1, [([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (1.0, 0.0, 0.0), 0, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (0.0, 1.0, 0.0), 1, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (0.0, 0.0, 1.0), 2, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'quaternion', (0.0, 0.0, 1.0), 3, 1.0, 0.0)], ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]), 1.0, [0.0, 0.0, 0.0], ((0.11561993112175119, 0.004646848850914142, 0.0021450370857165856), (0.004646848850914142, 0.08374124458762691, -0.008198737032263047), (0.0021450370857165856, -0.008198737032263047, 0.11458378195752493))), (0, [([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (1.0, 0.0, 0.0), 7, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (0.0, 1.0, 0.0), 8, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (0.0, 0.0, 1.0), 9, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'quaternion', (0.0, 0.0, 1.0), 10, 1.0, 0.0)], ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]), 2.0, [0.0, 0.0, 0.0], ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))]
RATES, ARMATURE, gravity = [('line', 0, 0), ('line', 1, 1), ('line', 2, 2), ('quaternion', 3, 3), ('line', 7, 6), ('line', 8, 7), ('line', 9, 8), ('quaternion', 10, 9)], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], ca.DM([0.0, 0.0, 0.0])
x, w, s, f = (ca.SX.sym(name, n) for name, n in zip("xwsf", (14, 12, 12, 12)))
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

q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
value = number(ca.jacobian(FD, w), q, v, 0, tau)
import numpy as np
value, expected = np.reshape(value, (12, 12))[(6, 4)], -2.0
assert abs(value - expected) <= 3.8e-12, f"{value = }, {expected = }"
