# pybullet 3.2.7, rotations: multiplyTransforms is imprecise (the point v of X, in the frame that X is in).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([-0.18877504894423414, 0.6317591176355501, 0.7331581168476692, 0.16650397557065305])
v = np.array([0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
value = p.multiplyTransforms(a, q, v, [0, 0, 0, 1])[0]
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], 0.9892222422495692
assert abs(value - expected) <= 1.8e-12, f"{value = }, {expected = }"
