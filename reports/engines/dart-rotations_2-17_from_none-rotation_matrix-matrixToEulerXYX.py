# dart 6.20.0, rotations, 2^-17 from none: matrixToEulerXYX, eulerXYXToMatrix is imprecise (rows of R).
import numpy as np
import dartpy as dart
q = np.array([0.9999999999719328, 4.8199832725041895e-06, 5.593603258995662e-06, 1.270336042097247e-06])
q2 = np.array([0.999999999973322, -2.603913535337215e-06, -4.86220453812469e-06, -4.789014747492394e-06])
R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))
value = dart.math.eulerXYXToMatrix(dart.math.matrixToEulerXYX(R)).ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(2,)], 1.1187218763674276e-05
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
