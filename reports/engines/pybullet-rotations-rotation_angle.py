# pybullet 3.2.7, rotations: getDifferenceQuaternion is imprecise (angle of R^T Q).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.2887209756040745, -0.34129830280374557, -0.6372954148539809, -0.6277023346743316])
angle = p.getAxisAngleFromQuaternion(p.getDifferenceQuaternion(q, q2))[1]
value = [min(angle, 2 * np.pi - angle)]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 1.7843964346188272
assert abs(value - expected) <= 3.2e-12, f"{value = }, {expected = }"
