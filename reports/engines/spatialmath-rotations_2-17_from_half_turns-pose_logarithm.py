# spatialmath 1.1.18, rotations, 2^-17 from half turns: trlog is wrong (twist (linear; angular) that leads to X in unit time).
import numpy as np
import spatialmath.base as sm
q = np.array([6.117185651155329e-06, 0.6433231366387009, 0.7465840232303513, 0.1695512845280324])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([6.117185651155329e-06, 0.6433231366387009, 0.7465840232303513, 0.1695512845280324])
T, U = sm.rt2tr(sm.q2r(q), a), sm.rt2tr(sm.q2r(q2), tau)
value = sm.trlog(T, twist=True)
import numpy as np
value, expected = np.reshape(value, (6,))[(4,)], 2.345453748725718
assert abs(value - expected) <= 2.4e-12, f"{value = }, {expected = }"
