# mink 1.3.0, rotations, 2^-27 from none: SO3.ljacinv is wrong (A^-1 at r = v, along the axes before).
# not finite.
import numpy as np
import mink
v = np.array([2.8918367975590624e-09, -7.646015247237875e-10, 2.0887972204351724e-09])
value = mink.SO3.ljacinv(v)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 1.0
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
