# pybullet 3.2.7, rotations: invertTransform is imprecise (rows of R^T).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.6, 0.8, 0.0, 0.0])
value = p.getMatrixFromQuaternion(p.invertTransform([0, 0, 0], q)[1])
import numpy as np
value, expected = np.reshape(value, (9,))[(0,)], -0.2800000000000001
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
