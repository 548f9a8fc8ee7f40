# mink 1.3.0, rotations, 2^-12 from none: SO3.ljacinv is imprecise (A^-1 at r = v, along the axes before).
import numpy as np
import mink
v = np.array([9.475970818241536e-05, -2.505446276214907e-05, 6.844570731921973e-05])
value = mink.SO3.ljacinv(v)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(1, 1)], 0.9999999988613152
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
