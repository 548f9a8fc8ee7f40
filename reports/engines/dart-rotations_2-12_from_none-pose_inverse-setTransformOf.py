# dart 6.20.0, rotations, 2^-12 from none: FreeJoint.setTransformOf is imprecise (X^-1).
import numpy as np
import dartpy as dart
q = np.array([0.9999999712430253, 0.00015428283863699245, 0.00017904563983240106, 4.0662184807919346e-05])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.9999999726725043, -8.33392507172514e-05, -0.0001556167198112647, -0.0001532742525101536])
R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))
X, Y = dart.math.Isometry3(R, a), dart.math.Isometry3(Q, tau)
s = dart.dynamics.Skeleton('s')
j, b = s.createFreeJointAndBodyNodePair(None)
dart.dynamics.FreeJoint.setTransformOf(b, X)
Z = b.getTransform().inverse()
value = [*Z.translation(), *Z.rotation().flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(9,)], 0.0003581038163217749
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
