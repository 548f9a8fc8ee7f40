# pybullet 3.2.7, rotations: invertTransform, multiplyTransforms is imprecise (X^-1 Y).
# Known: https://github.com/bulletphysics/bullet3/issues/2246.
import numpy as np
import pybullet as p
q = np.array([0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.1, 0.5, 0.5, 0.7])
x, turn = p.multiplyTransforms(*p.invertTransform(a, q), tau, q2)
value = [*x, *p.getMatrixFromQuaternion(turn)]
import numpy as np
value, expected = np.reshape(value, (12,))[(3,)], -6.106226635438361e-17
assert abs(value - expected) <= 2.7e-12, f"{value = }, {expected = }"
