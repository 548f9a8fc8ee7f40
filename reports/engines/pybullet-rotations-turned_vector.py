# pybullet 3.2.7, rotations: rotateVector is imprecise (R v).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.1, 0.5, 0.5, 0.7])
v = np.array([0.0, 0.0, 1.0])
value = p.rotateVector(q, v)
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], 0.48
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
