# exudyn-joints 1.13.6, rotations: RotationVector2RotationMatrix is wrong (rows of the rotation by the vector v).
import numpy as np, exudyn as exu
import exudyn.utilities as ut
v = np.array([0.0, 0.0, 28.0])
value = ut.RotationVector2RotationMatrix(v).ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(0,)], -0.9626058663135666
assert abs(value - expected) <= 1.5e-11, f"{value = }, {expected = }"
