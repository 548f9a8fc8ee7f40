# spatialmath 1.1.18, rotations, 2^-8 from half turns: trlog is imprecise (twist that leads from X to Y, along the axes of X).
import numpy as np
import spatialmath.base as sm
q = np.array([0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.999998879906223, -0.0009444250055383461, -0.0008630735853607339, -0.0007767571657228215])
T, U = sm.rt2tr(sm.q2r(q), a), sm.rt2tr(sm.q2r(q2), tau)
value = sm.trlog(sm.trinv(T) @ U, twist=True)
import numpy as np
value, expected = np.reshape(value, (6,))[(5,)], 3.1400365692371643
assert abs(value - expected) <= 4.5e-12, f"{value = }, {expected = }"
