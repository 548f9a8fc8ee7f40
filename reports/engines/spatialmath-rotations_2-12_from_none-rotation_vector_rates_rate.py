# spatialmath 1.1.18, rotations, 2^-12 from none: rotvelxform_inv_dot is wrong (time derivative of the latter at r = tau, r' = a).
import numpy as np
import spatialmath.base as sm
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, -0.00014729388586947332])
value = sm.rotvelxform_inv_dot(tau, a, representation='exp')
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 2.4548980995998958e-05
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
