# dart 6.20.0, ball, 2^-12 from zero: getBodyForce is imprecise (what holds each link with all it carries, at its origin along its axes).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0002307611739667253, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0])
s.setPositions(q)
s.setVelocities(v)
s.setAccelerations(a)
s.computeInverseDynamics()
value = [np.roll(b.getBodyForce(), 3, axis=0) for b in links]
import numpy as np
value, expected = np.reshape(value, (1, 6))[(0, 1)], 0.0022637670965223707
assert abs(value - expected) <= 1.7e-11, f"{value = }, {expected = }"
