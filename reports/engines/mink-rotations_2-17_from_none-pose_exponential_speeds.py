# mink 1.3.0, rotations, 2^-17 from none: SE3.rjac is wrong (J: the twist of exp x in its own frame is J x', at x = (v; v2)).
import numpy as np
import mink
v = np.array([0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, 0.0])
V = np.r_[v, v2]
value = mink.SE3.rjac(V)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 4)], 0.5
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
