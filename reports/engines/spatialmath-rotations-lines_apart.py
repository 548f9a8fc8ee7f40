# spatialmath 1.1.18, rotations: Line3.distance is wrong (distance of the two lines).
# Known: https://github.com/bdaiinstitute/spatialmath-python/pull/224.
import numpy as np
import spatialmath.base as sm
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
v2 = np.array([0.0, 0.0, 0.0])
import spatialmath as cls
away, aside, beside = (np.array(u) for u in ([4.0, -8, 8], [8.0, 4, 4], [8.0, -4, 4]))
def unit(x): return x / np.linalg.norm(x)
L, M = cls.Line3.PointDir(a, unit(v + away)), cls.Line3.PointDir(tau, unit(v2 + aside))
value = [L.distance(M)]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.7071067811865476
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
