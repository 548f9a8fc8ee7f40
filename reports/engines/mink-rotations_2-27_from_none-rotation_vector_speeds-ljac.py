# mink 1.3.0, rotations, 2^-27 from none: SO3.ljac is imprecise (A at r = tau, in the turned axes).
import numpy as np
import mink
tau = np.array([-6.666994525157017e-09, 4.581736450708939e-09, 4.668613311494632e-09])
value = mink.SO3.ljac(tau).T
import numpy as np
value, expected = np.reshape(value, (3, 3))[(2, 1)], 3.3334972661435675e-09
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
