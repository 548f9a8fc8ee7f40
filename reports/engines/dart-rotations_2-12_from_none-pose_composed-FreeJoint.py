# dart 6.20.0, rotations, 2^-12 from none: FreeJoint.setTransform of a frame is imprecise (X Y).
import numpy as np
import dartpy as dart
q = np.array([1.0, 0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([0.9999999726725043, -8.33392507172514e-05, -0.0001556167198112647, -0.0001532742525101536])
R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))
X, Y = dart.math.Isometry3(R, a), dart.math.Isometry3(Q, tau)
W = dart.dynamics.Frame.World()
one = dart.dynamics.SimpleFrame(W, 'one', X)
s = dart.dynamics.Skeleton('s')
j, b = s.createFreeJointAndBodyNodePair(None)
j.setTransform(Y, one)
Z = b.getTransform()
value = [*Z.translation(), *Z.rotation().flat]
import numpy as np
value, expected = np.reshape(value, (12,))[(9,)], 0.00031125897864001583
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
