# pybullet 3.2.7, rotations, 2^-17 from none: getQuaternionSlerp is wrong (rows of the rotation a quarter of the way from R to Q, the shorter way).
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
q2 = np.array([2.2027935874271194e-06, -2.6039317415123067e-06, -4.862238533933672e-06, 0.9999999999823629])
value = p.getMatrixFromQuaternion(p.getQuaternionSlerp(q, q2, 0.25))
import numpy as np
value, expected = np.reshape(value, (9,))[(3,)], -2.4311199839680736e-06
assert abs(value - expected) <= 1.7e-12, f"{value = }, {expected = }"
