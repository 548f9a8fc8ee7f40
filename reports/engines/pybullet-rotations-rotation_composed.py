# pybullet 3.2.7, rotations: multiplyTransforms is imprecise (rows of R Q).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.2887209756040745, -0.34129830280374557, -0.6372954148539809, -0.6277023346743316])
x, turn = p.multiplyTransforms(0 * v, q, 0 * v, q2)
value = p.getMatrixFromQuaternion(turn)
import numpy as np
value, expected = np.reshape(value, (9,))[(2,)], 0.0604663751313066
assert abs(value - expected) <= 2.3e-12, f"{value = }, {expected = }"
