# mink 1.3.0, rotations, 2^-27 from none: SO3.rjacinv is wrong (A^-1 at r = tau, in the turned axes).
# not finite.
import numpy as np
import mink
tau = np.array([-6.666994525157017e-09, 4.581736450708939e-09, 4.668613311494632e-09])
value = mink.SO3.rjacinv(tau)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 1.0
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
