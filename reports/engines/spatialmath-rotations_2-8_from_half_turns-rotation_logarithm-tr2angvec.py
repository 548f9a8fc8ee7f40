# spatialmath 1.1.18, rotations, 2^-8 from half turns: tr2angvec is imprecise (rotation vector of R).
import numpy as np
import spatialmath.base as sm
q = np.array([0.003140686220458112, 0.6419089496739872, 0.7479312532619985, 0.16894341304839183])
q2 = np.array([0.003140686220458112, 0.6419089496739872, 0.7479312532619985, 0.16894341304839183])
R, Q = sm.q2r(q), sm.q2r(q2)
angle, axis = sm.tr2angvec(R)
value = angle * axis
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], 2.3450088536592144
assert abs(value - expected) <= 3.1e-12, f"{value = }, {expected = }"
