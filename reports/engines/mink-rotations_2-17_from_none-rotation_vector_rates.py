# mink 1.3.0, rotations, 2^-17 from none: SO3.rjacinv is wrong (A^-1 at r = tau, in the turned axes).
import numpy as np
import mink
tau = np.array([0.0, 0.0, 4.780660030970503e-06])
value = mink.SO3.rjacinv(tau)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 0.9999999999980954
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
