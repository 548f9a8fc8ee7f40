# mink 1.3.0, rotations, 2^-17 from none: SE3.exp is imprecise (where the twist (v; v2) leads in unit time).
import numpy as np
import mink
v = np.array([0.0, -5.460399350194339e-06, 0.0])
v2 = np.array([0.0, 0.0, 3.985594365660811e-06])
V = np.r_[v, v2]
T = (mink.SE3.exp(V)).as_matrix()
value = [*T[:3, 3], *T[:3, :3].flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(0,)], 1.0881468442181852e-11
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
