# mink 1.3.0, rotations, 2^-27 from none: SE3.jlog is wrong (J: the rates of the twist that leads to X are J times the twist of X in its own frame).
import numpy as np
import mink
q = np.array([1.0, 4.706972265475104e-09, 5.46245368824376e-09, 1.2405513006850294e-09])
a = np.array([-0.45902228709100545, -0.39625206603607555, -0.8533158648967247])
tau = np.array([-6.666994525157017e-09, 4.581736450708939e-09, 4.668613311494632e-09])
q2 = np.array([1.0, -2.5428705261084143e-09, -4.748220877582511e-09, -4.676746860152509e-09])
X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])
value = X.jlog()
import numpy as np
value, expected = np.reshape(value, (6, 6))[(1, 3)], -0.4266579334982385
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
