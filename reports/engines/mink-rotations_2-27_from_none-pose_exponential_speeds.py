# mink 1.3.0, rotations, 2^-27 from none: SE3.rjac is imprecise (J: the twist of exp x in its own frame is J x', at x = (v; v2)).
import numpy as np
import mink
v = np.array([2.8918367975590624e-09, -7.646015247237875e-10, 2.0887972204351724e-09])
v2 = np.array([-7.3764977982727005e-09, -2.5323727116361636e-09, -6.123082986310683e-09])
V = np.r_[v, v2]
value = mink.SE3.rjac(V)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(2, 1)], 3.6882489017206718e-09
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
