# mink 1.3.0, rotations, 2^-40 from none: SE3.rminus is imprecise (twist that leads from X to Y, along the axes of X).
import numpy as np
import mink
q = np.array([1.0, 5.745815702868942e-13, 6.668034228354934e-13, 1.5143448360580176e-13])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([1.0, -3.104089981242999e-13, -5.796168032742509e-13, -5.708919476771713e-13])
X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])
value = Y.rminus(X)
import numpy as np
value, expected = np.reshape(value, (6,))[(4,)], -2.492840452220051e-12
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
