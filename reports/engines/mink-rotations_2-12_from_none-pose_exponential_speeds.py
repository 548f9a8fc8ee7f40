# mink 1.3.0, rotations, 2^-12 from none: SE3.rjac is imprecise (J: the twist of exp x in its own frame is J x', at x = (v; v2)).
import numpy as np
import mink
v = np.array([0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, -0.00020064118329542847])
V = np.r_[v, v2]
value = mink.SE3.rjac(V)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 4)], 0.49999999496788944
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
