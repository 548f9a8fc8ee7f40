# spatialmath 1.1.18, rotations, 2^-8 from none: rotvelxform_inv_dot is imprecise (time derivative of the latter at r = tau, r' = a).
import numpy as np
import spatialmath.base as sm
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0024476979358568976])
value = sm.rotvelxform_inv_dot(tau, a, representation='exp')
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], -0.00040794973744677547
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
