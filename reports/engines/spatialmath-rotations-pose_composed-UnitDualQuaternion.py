# spatialmath 1.1.18, rotations: UnitDualQuaternion is wrong (X Y).
# Known: https://github.com/bdaiinstitute/spatialmath-python/pull/225.
import numpy as np
import spatialmath.base as sm
q = np.array([0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.0, 0.0, 0.0, 1.0])
import spatialmath as cls
T, U = sm.rt2tr(sm.q2r(q), a), sm.rt2tr(sm.q2r(q2), tau)
X, Y = cls.SE3(T), cls.SE3(U)
D = cls.UnitDualQuaternion(X) * cls.UnitDualQuaternion(Y)
Z = cls.UnitDualQuaternion(D.real, D.dual).SE3().A
value = [*Z[:3, 3], *Z[:3, :3].flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(2,)], 1.0
assert abs(value - expected) <= 2.8e-12, f"{value = }, {expected = }"
