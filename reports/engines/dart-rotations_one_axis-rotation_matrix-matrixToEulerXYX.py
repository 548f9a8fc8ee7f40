# dart 6.20.0, rotations, one axis: matrixToEulerXYX, eulerXYXToMatrix is wrong (rows of R).
import numpy as np
import dartpy as dart
q = np.array([0.6, 0.8, 0.0, 0.0])
q2 = np.array([0.6, 0.8, 0.0, 0.0])
R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))
value = dart.math.eulerXYXToMatrix(dart.math.matrixToEulerXYX(R)).ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(5,)], -0.96
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
