# spatialmath 1.1.18, rotations, 2^-17 from half turns: tr2angvec is wrong (rotation vector of R).
import numpy as np
import spatialmath.base as sm
q = np.array([6.117185651155329e-06, 0.6433231366387009, 0.7465840232303513, 0.1695512845280324])
q2 = np.array([6.117185651155329e-06, 0.6433231366387009, 0.7465840232303513, 0.1695512845280324])
R, Q = sm.q2r(q), sm.q2r(q2)
angle, axis = sm.tr2angvec(R)
value = angle * axis
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], 2.345453748725718
assert abs(value - expected) <= 2.4e-12, f"{value = }, {expected = }"
