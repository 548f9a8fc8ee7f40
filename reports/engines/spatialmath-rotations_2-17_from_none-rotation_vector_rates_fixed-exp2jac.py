# spatialmath 1.1.18, rotations, 2^-17 from none: exp2jac is imprecise (A^-1 at r = v, along the axes before).
import numpy as np
import spatialmath.base as sm
v = np.array([0.0, 0.0, 2.1389283537256165e-06])
value = np.linalg.inv(sm.exp2jac(v))
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 1)], 1.0694641768628083e-06
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
