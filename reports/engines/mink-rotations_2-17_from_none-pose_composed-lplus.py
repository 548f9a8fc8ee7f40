# mink 1.3.0, rotations, 2^-17 from none: SE3.lplus is wrong (X Y).
import numpy as np
import mink
q = np.array([0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.0, 0.0, 0.0, 1.0])
X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])
T = (Y.lplus(X.log())).as_matrix()
value = [*T[:3, 3], *T[:3, :3].flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(3,)], 1.0
assert abs(value - expected) <= 2.8e-12, f"{value = }, {expected = }"
