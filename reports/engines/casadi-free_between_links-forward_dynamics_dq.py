# casadi 3.8.2, free between links: jacobian of solve is imprecise (derivative of forward dynamics by q).
import casadi as ca
import numpy as np
# Links: parent, motions (placement R, p; how, axis, place in q, factor, offset), placement after them, m, c, J.
LINKS = [(-1, [([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'turn', (1.0, 0.0, 0.0), 0, 1.0, 0.0)], ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]), 0.6765507958507797, [0.038475579660143394, 0.0685445471881444, 0.16772610790641557], ((0.11085774402365212, 0.0072557254355869755, 0.0024878692008303647), (0.0072557254355869755, 0.09865359055623911, -0.010239722784081704), (0.0024878692008303647, -0.010239722784081704, 0.10809880371154328))), (0, [([[-0.26529991822610355, 0.013803312672644882, -0.9640671252296097], [-0.535560800480858, -0.83356416652579, 0.13544522609700077], [-0.8017422169111, 0.5522501687128997, 0.22853701839975152]], [-0.35758652276965186, 0.1456270494171541, 0.08529479996669709], 'slide', (1.0, 0.0, 0.0), 1, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (0.0, 1.0, 0.0), 2, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'slide', (0.0, 0.0, 1.0), 3, 1.0, 0.0), ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0], 'quaternion', (0.0, 0.0, 1.0), 4, 1.0, 0.0)], ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]), 1.1163387396681819, [0.12215617467052264, 0.1379380955361733, 0.03388386110585845], ((0.1416494380633066, -0.00909557302319254, -0.01540705775631842), (-0.00909557302319254, 0.1591682285188363, 0.0105181790718728), (-0.01540705775631842, 0.0105181790718728, 0.14321877224447596))), (1, [([[-0.18112611981352295, -0.5576285187305469, -0.8100887382377769], [0.6943357867442113, -0.655859779395552, 0.2962191165632549], [-0.6964848483402885, -0.5088205821992602, 0.5059747732474529]], [0.42835798735095565, -0.11047094541430258, -0.017606126620452134], 'turn', (0.6666666666666666, -0.3333333333333333, 0.6666666666666666), 8, 1.0, 0.0)], ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0, 0.0, 0.0]), 1.1864141028802657, [0.19264154360466174, -0.13972876412009208, -0.04821117232870037], ((0.14868554063051195, -0.00469323305686024, 0.00826694096080588), (-0.00469323305686024, 0.14093562150231922, 0.011080404261953926), (0.00826694096080588, 0.011080404261953926, 0.14149962536637015)))]
RATES, ARMATURE, gravity = [('line', 0, 0), ('line', 1, 1), ('line', 2, 2), ('line', 3, 3), ('quaternion', 4, 4), ('line', 8, 7)], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], ca.DM([0.0, 0.0, -9.81])
x, w, s, f = (ca.SX.sym(name, n) for name, n in zip("xwsf", (9, 8, 8, 8)))
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

q = np.array([-1.0996201868492035, -0.7565606148471162, 0.04521670343786499, -0.1816631824515902, -0.2883303653290383, -0.5383900777644088, -0.5302857998054892, -0.588046507615435, 1.5665266789484145])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
value = number(by_q(FD), q, v, 0, tau)
import numpy as np
value, expected = np.reshape(value, (8, 8))[(5, 1)], 0.0
assert abs(value - expected) <= 1.6e-11, f"{value = }, {expected = }"
