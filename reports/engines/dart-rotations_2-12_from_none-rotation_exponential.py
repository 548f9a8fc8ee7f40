# dart 6.20.0, rotations, 2^-12 from none: expMapRot is imprecise (rows of the rotation by the vector v).
import numpy as np
import dartpy as dart
v = np.array([0.0, -0.00017473277920621884, -8.368118395260619e-05])
value = dart.math.expMapRot(v).ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(2,)], -0.00017473277811314635
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
