# mink 1.3.0, rotations, 2^-17 from none: SE3.interpolate is imprecise (a quarter of the way from X to Y, along the screw).
import numpy as np
import mink
q = np.array([1.0, 0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.999999999973322, -2.603913535337215e-06, -4.86220453812469e-06, -4.789014747492394e-06])
X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])
T = (X.interpolate(Y, 0.25)).as_matrix()
value = [*T[:3, 3], *T[:3, :3].flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(0,)], -9.116637406026617e-07
assert abs(value - expected) <= 1.7e-12, f"{value = }, {expected = }"
