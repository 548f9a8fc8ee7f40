# pybullet 3.2.7, rotations: getQuaternionSlerp is imprecise (rows of the rotation a quarter of the way from R to Q, the shorter way).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.2887209756040745, -0.34129830280374557, -0.6372954148539809, -0.6277023346743316])
value = p.getMatrixFromQuaternion(p.getQuaternionSlerp(q, q2, 0.25))
import numpy as np
value, expected = np.reshape(value, (9,))[(7,)], -0.12489462645574977
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
