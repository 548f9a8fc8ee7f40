# spatialmath 1.1.18, rotations, 2^-8 from half turns: SO3.angdist is imprecise (angle of R^T Q).
import numpy as np
import spatialmath.base as sm
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.999998879906223, -0.0009444250055383461, -0.0008630735853607339, -0.0007767571657228215])
import spatialmath as cls
R, Q = sm.q2r(q), sm.q2r(q2)
value = [cls.SO3(R).angdist(cls.SO3(Q), metric=6)]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 3.1400391391021283
assert abs(value - expected) <= 4.0e-12, f"{value = }, {expected = }"
