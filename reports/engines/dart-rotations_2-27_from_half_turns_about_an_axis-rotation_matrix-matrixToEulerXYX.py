# dart 6.20.0, rotations, 2^-27 from half turns about an axis: matrixToEulerXYX, eulerXYXToMatrix is imprecise (rows of R).
import numpy as np
import dartpy as dart
q = np.array([4.748220877582511e-09, -4.676746860152509e-09, 1.0, 2.5428705261084143e-09])
q2 = np.array([1.0, 4.706972265475104e-09, 5.46245368824376e-09, 1.2405513006850294e-09])
R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))
value = dart.math.eulerXYXToMatrix(dart.math.matrixToEulerXYX(R)).ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(6,)], -9.496441778949745e-09
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
