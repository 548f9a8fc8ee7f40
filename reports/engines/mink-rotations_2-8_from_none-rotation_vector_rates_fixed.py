# mink 1.3.0, rotations, 2^-8 from none: SO3.ljacinv is imprecise (A^-1 at r = v, along the axes before).
import numpy as np
import mink
v = np.array([0.0, 0.0, 0.0010951313171075156])
value = mink.SO3.ljacinv(v)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 0.9999999000572812
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
