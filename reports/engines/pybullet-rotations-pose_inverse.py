# pybullet 3.2.7, rotations: invertTransform is imprecise (X^-1).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.6, 0.8, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0])
x, turn = p.invertTransform(a, q)
value = [*x, *p.getMatrixFromQuaternion(turn)]
import numpy as np
value, expected = np.reshape(value, (12,))[(3,)], -0.2800000000000001
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
