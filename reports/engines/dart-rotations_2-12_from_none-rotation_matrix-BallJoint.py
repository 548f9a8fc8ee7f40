# dart 6.20.0, rotations, 2^-12 from none: BallJoint.convertToPositions, convertToRotation is imprecise (rows of R).
import numpy as np
import dartpy as dart
q = np.array([0.9999999712430253, 0.00015428283863699245, 0.00017904563983240106, 4.0662184807919346e-05])
q2 = np.array([0.9999999726725043, -8.33392507172514e-05, -0.0001556167198112647, -0.0001532742525101536])
R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))
value = dart.dynamics.BallJoint.convertToRotation(dart.dynamics.BallJoint.convertToPositions(R)).ravel()
import numpy as np
value, expected = np.reshape(value, (9,))[(2,)], 0.0003581038163217749
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
