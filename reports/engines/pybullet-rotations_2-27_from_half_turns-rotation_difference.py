# pybullet 3.2.7, rotations, 2^-27 from half turns: calculateVelocityQuaternion is wrong (rotation vector of R^T Q).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.0, 1.0, 0.0, 0.0])
q2 = np.array([-1.406483725581562e-09, 4.7069722530155835e-09, 5.462453673784454e-09, 1.0])
R = np.reshape(p.getMatrixFromQuaternion(q), (3, 3))
value = R.T @ p.calculateVelocityQuaternion(q, q2, 1.0)
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], -3.141592644175849
assert abs(value - expected) <= 4.5e-12, f"{value = }, {expected = }"
