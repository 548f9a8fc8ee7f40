# dart 6.20.0, ball, 2^-12 from zero: integratePositions is imprecise (where q' = N(q) v2 leads in unit time).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([-0.00022164861763099107, 0.0, 0.0])
v2 = np.array([0.0, 0.0, 0.0])
s.setPositions(q)
s.setVelocities(v2)
s.integratePositions(1.0)
value = s.getPositions()
import numpy as np
value, expected = np.reshape(value, (3,))[(0,)], -0.00022164861763099107
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
