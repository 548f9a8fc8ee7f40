# mink 1.3.0, rotations, 2^-8 from none: SO3.rjacinv is imprecise (A^-1 at r = tau, in the turned axes).
import numpy as np
import mink
tau = np.array([0.0, 0.0, 0.0024476979358568976])
value = mink.SO3.rjacinv(tau)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 0.9999995007311847
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
