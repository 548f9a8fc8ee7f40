# dart 6.20.0, rotations, 2^-40 from none: quatToExp, expToQuat is imprecise (rows of R).
import numpy as np
import dartpy as dart
q = np.array([1.0, 5.745815702868942e-13, 6.668034228354934e-13, 1.5143448360580176e-13])
value = dart.math.expToQuat(dart.math.quatToExp(dart.math.Quaternion(*q))).to_rotation_matrix().ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(2,)], 1.333606845671161e-12
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
