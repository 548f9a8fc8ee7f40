# mink 1.3.0, rotations, 2^-12 from none: SO3.rjacinv is imprecise (A^-1 at r = tau, in the turned axes).
import numpy as np
import mink
tau = np.array([-0.00021846407660034513, 0.0001501343400168305, 0.0001529811209910561])
value = mink.SO3.rjacinv(tau)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(1, 1)], 0.9999999940725186
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
