# mink 1.3.0, rotations, 2^-40 from none: SO3.log is imprecise (rotation vector of R).
import numpy as np
import mink
q = np.array([1.0, 5.745815702868942e-13, 6.668034228354934e-13, 1.5143448360580176e-13])
q2 = np.array([1.0, -3.104089981242999e-13, -5.796168032742509e-13, -5.708919476771713e-13])
R, Q = mink.SO3(q), mink.SO3(q2)
value = R.log()
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], 1.3336068456709868e-12
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
