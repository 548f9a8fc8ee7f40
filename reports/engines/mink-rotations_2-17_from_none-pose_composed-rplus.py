# mink 1.3.0, rotations, 2^-17 from none: SE3.rplus is imprecise (X Y).
import numpy as np
import mink
q = np.array([0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, -4.602933933421041e-06])
q2 = np.array([0.9999999999969494, 8.58820965596662e-07, 2.315627747364275e-06, 3.740622574275316e-08])
X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])
T = (X.rplus(Y.log())).as_matrix()
value = [*T[:3, 3], *T[:3, :3].flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(0,)], 0.0
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
