# dart 6.20.0, ball, 2^-12 from zero: getJacobian is imprecise (Jacobians of the links).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createRevoluteJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createBallJointAndBodyNodePair(b0)
b1.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1]
q = np.array([0.0, -0.00022164861763099107, 0.0, 0.0])
s.setPositions(q)
value = [np.roll(s.getJacobian(b), 3, axis=0) for b in links]
import numpy as np
value, expected = np.reshape(value, (2, 6, 4))[(1, 4, 0)], -0.00022164861581612814
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
