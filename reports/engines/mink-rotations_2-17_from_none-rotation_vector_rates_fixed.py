# mink 1.3.0, rotations, 2^-17 from none: SO3.ljacinv is wrong (A^-1 at r = v, along the axes before).
import numpy as np
import mink
v = np.array([0.0, 0.0, 2.1389283537256165e-06])
value = mink.SO3.ljacinv(v)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 0.9999999999996187
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
