# pybullet 3.2.7, rotations, 2^-8 from none: getAxisAngleFromQuaternion is wrong (rotation vector of R).
import numpy as np
import pybullet as p
q = np.array([-0.0007398057211468296, 0.002475851614010287, 0.002873232306825516, 0.9999925336633226])
axis, angle = p.getAxisAngleFromQuaternion(q)
value = (angle - 2 * np.pi * (angle > np.pi)) * np.array(axis)
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], 0.005746478915373581
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
