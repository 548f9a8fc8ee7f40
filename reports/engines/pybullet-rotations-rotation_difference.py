# pybullet 3.2.7, rotations: calculateVelocityQuaternion is imprecise (rotation vector of R^T Q).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.2887209756040745, -0.34129830280374557, -0.6372954148539809, -0.6277023346743316])
R = np.reshape(p.getMatrixFromQuaternion(q), (3, 3))
value = R.T @ p.calculateVelocityQuaternion(q, q2, 1.0)
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], 0.7823351184809855
assert abs(value - expected) <= 3.6e-12, f"{value = }, {expected = }"
