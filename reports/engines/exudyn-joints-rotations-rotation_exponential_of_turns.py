# exudyn-joints 1.13.6, rotations: RotationVector2RotationMatrix is wrong (rows of the rotation by the vector 16 v).
import numpy as np, exudyn as exu
import exudyn.utilities as ut
v = np.array([1.0, 0.0, 0.0])
value = ut.RotationVector2RotationMatrix(16 * v).ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(4,)], -0.9576594803233847
assert abs(value - expected) <= 7.8e-12, f"{value = }, {expected = }"
