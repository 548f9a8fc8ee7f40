# pybullet 3.2.7, rotations, 2^-8 from none: getDifferenceQuaternion is wrong (angle of R^T Q).
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([0.0011350277772848125, -0.0013417212005879195, -0.0025053531240052667, 0.9999953173399807])
angle = p.getAxisAngleFromQuaternion(p.getDifferenceQuaternion(q, q2))[1]
value = [min(angle, 2 * np.pi - angle)]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.006120564466679112
assert abs(value - expected) <= 1.8e-12, f"{value = }, {expected = }"
