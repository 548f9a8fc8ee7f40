# spatialmath 1.1.18, rotations, 2^-22 from none: SE3 * Line3 is imprecise (the same of that line, given in Y, in the frame that Y is in).
# Known: https://github.com/bdaiinstitute/spatialmath-python/issues/64.
import numpy as np
import spatialmath.base as sm
q = np.array([0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, -0.4, -1.0])
tau = np.array([0.0, 0.0, 0.0])
v2 = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.9999999999999739, -8.137187020345714e-08, -1.51943093044257e-07, -1.496559241107547e-07])
import spatialmath as cls
T, U = sm.rt2tr(sm.q2r(q), a), sm.rt2tr(sm.q2r(q2), tau)
X, Y = cls.SE3(T), cls.SE3(U)
import spatialmath as cls
away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))
def unit(x): return x / np.linalg.norm(x)
L, M = cls.Line3.PointDir(a, unit(v + away)), cls.Line3.PointDir(tau, unit(v2 + aside))
L = Y * L
value = np.r_[-L.v, L.w] / np.linalg.norm(L.w)
import numpy as np
value, expected = np.reshape(value, (6,))[(3,)], 0.3333329312012799
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
