# spatialmath 1.1.18, rotations: Plane3.LinePoint is wrong (distance of the origin from the plane of the first line and tau).
import numpy as np
import spatialmath.base as sm
v = np.array([0.0, 0.0, 0.0])
a = np.array([-0.45902228709100545, -0.39625206603607555, -0.8533158648967247])
tau = np.array([0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, 0.0])
import spatialmath as cls
away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))
def unit(x): return x / np.linalg.norm(x)
L, M = cls.Line3.PointDir(a, unit(v + away)), cls.Line3.PointDir(tau, unit(v2 + aside))
P = cls.Plane3.LinePoint(L, tau)
value = [abs(P.d) / np.linalg.norm(P.n)]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.2749819392335687
assert abs(value - expected) <= 1.3e-12, f"{value = }, {expected = }"
