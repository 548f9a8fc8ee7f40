# mink 1.3.0, rotations, 2^-22 from none: SE3.lplus is imprecise (X Y).
import numpy as np
import mink
q = np.array([0.9999999999999726, 1.5062315385164736e-07, 1.7479856601806236e-07, 3.9697652521664455e-08])
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.9999999999999739, -8.137187020345714e-08, -1.51943093044257e-07, -1.496559241107547e-07])
X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])
T = (Y.lplus(X.log())).as_matrix()
value = [*T[:3, 3], *T[:3, :3].flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(0,)], 0.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
