# mink 1.3.0, rotations, 2^-17 from none: SO3.ljac is imprecise (A at r = tau, in the turned axes).
import numpy as np
import mink
tau = np.array([0.0, 0.0, 4.780660030970503e-06])
value = mink.SO3.ljac(tau).T
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 1)], 2.390330015480699e-06
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
