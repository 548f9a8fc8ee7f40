# dart 6.20.0, rotations, 2^-40 from none: expToQuat is imprecise (rows of the rotation by the vector v).
import numpy as np
import dartpy as dart
v = np.array([0.0, 0.0, 2.549801294476529e-11])
value = dart.math.expToQuat(v).to_rotation_matrix().ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(1,)], -2.549801294476529e-11
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
