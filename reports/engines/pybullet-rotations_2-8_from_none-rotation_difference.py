# pybullet 3.2.7, rotations, 2^-8 from none: calculateVelocityQuaternion is wrong (rotation vector of R^T Q).
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.0011350277772848125, -0.0013417212005879195, -0.0025053531240052667, 0.9999953173399807])
R = np.reshape(p.getMatrixFromQuaternion(q), (3, 3))
value = R.T @ p.calculateVelocityQuaternion(q, q2, 1.0)
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], -0.005010714069169788
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
