# pybullet 3.2.7, rotations: getQuaternionFromAxisAngle is imprecise (rows of the rotation by the vector v).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
v = np.array([0.0, 0.0, 1.0])
n = np.linalg.norm(v)
value = p.getMatrixFromQuaternion(p.getQuaternionFromAxisAngle(v if n else [1, 0, 0], n))
import numpy as np
value, expected = np.reshape(value, (9,))[(0,)], 0.5403023058681398
assert abs(value - expected) <= 1.6e-12, f"{value = }, {expected = }"
