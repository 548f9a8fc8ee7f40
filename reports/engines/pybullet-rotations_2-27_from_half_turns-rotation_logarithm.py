# pybullet 3.2.7, rotations, 2^-27 from half turns: getAxisAngleFromQuaternion is wrong (rotation vector of R).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([-0.19144750734185215, 0.6407028280014869, 0.7435373145468145, 5.571533957850198e-09])
axis, angle = p.getAxisAngleFromQuaternion(q)
value = (angle - 2 * np.pi * (angle > np.pi)) * np.array(axis)
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], 2.335891356764869
assert abs(value - expected) <= 2.5e-12, f"{value = }, {expected = }"
