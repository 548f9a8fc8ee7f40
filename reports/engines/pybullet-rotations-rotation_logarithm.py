# pybullet 3.2.7, rotations: getAxisAngleFromQuaternion is imprecise (rotation vector of R).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.5, 0.5, 0.5, 0.5])
axis, angle = p.getAxisAngleFromQuaternion(q)
value = (angle - 2 * np.pi * (angle > np.pi)) * np.array(axis)
import numpy as np
value, expected = np.reshape(value, (3,))[(0,)], 1.2091995761561452
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
