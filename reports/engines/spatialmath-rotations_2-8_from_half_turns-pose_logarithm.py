# spatialmath 1.1.18, rotations, 2^-8 from half turns: trlog is imprecise (twist (linear; angular) that leads to X in unit time).
import numpy as np
import spatialmath.base as sm
q = np.array([0.003140686220458112, 0.6419089496739872, 0.7479312532619985, 0.16894341304839183])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.003140686220458112, 0.6419089496739872, 0.7479312532619985, 0.16894341304839183])
T, U = sm.rt2tr(sm.q2r(q), a), sm.rt2tr(sm.q2r(q2), tau)
value = sm.trlog(T, twist=True)
import numpy as np
value, expected = np.reshape(value, (6,))[(4,)], 2.3450088536592144
assert abs(value - expected) <= 3.1e-12, f"{value = }, {expected = }"
