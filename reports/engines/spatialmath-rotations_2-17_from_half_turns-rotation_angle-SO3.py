# spatialmath 1.1.18, rotations, 2^-17 from half turns: SO3.angdist is wrong (angle of R^T Q).
import numpy as np
import spatialmath.base as sm
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.999999999995791, -1.8307395771225367e-06, -1.6730422864950147e-06, -1.5057204931710799e-06])
import spatialmath as cls
R, Q = sm.q2r(q), sm.q2r(q2)
value = [cls.SO3(R).angdist(cls.SO3(Q), metric=6)]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 3.1415896421488068
assert abs(value - expected) <= 4.0e-12, f"{value = }, {expected = }"
