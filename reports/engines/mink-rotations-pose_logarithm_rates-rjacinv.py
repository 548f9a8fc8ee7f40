# mink 1.3.0, rotations: SE3.rjacinv is wrong (J: the rates of the twist that leads to X are J times the twist of X in its own frame).
import numpy as np
import mink
q = np.array([1.0, 0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([1.0, 0.0, 0.0, 0.0])
X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])
value = mink.SE3.rjacinv(X.log())
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 4)], -0.5
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
