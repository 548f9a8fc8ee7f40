# spatialmath 1.1.18, rotations, 2^-17 from half turns: trlog is wrong (twist that leads from X to Y, along the axes of X).
import numpy as np
import spatialmath.base as sm
q = np.array([0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.999999999995791, -1.8307395771225367e-06, -1.6730422864950147e-06, -1.5057204931710799e-06])
T, U = sm.rt2tr(sm.q2r(q), a), sm.rt2tr(sm.q2r(q2), tau)
value = sm.trlog(sm.trinv(T) @ U, twist=True)
import numpy as np
value, expected = np.reshape(value, (6,))[(5,)], 3.1415896421391456
assert abs(value - expected) <= 4.5e-12, f"{value = }, {expected = }"
