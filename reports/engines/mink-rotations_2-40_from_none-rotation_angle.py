# mink 1.3.0, rotations, 2^-40 from none: SO3.minus is imprecise (angle of R^T Q).
import numpy as np
import mink
q = np.array([1.0, 5.745815702868942e-13, 6.668034228354934e-13, 1.5143448360580176e-13])
q2 = np.array([1.0, -3.104089981242999e-13, -5.796168032742509e-13, -5.708919476771713e-13])
R, Q = mink.SO3(q), mink.SO3(q2)
value = [np.linalg.norm(Q.minus(R))]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 3.3814358840955304e-12
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
