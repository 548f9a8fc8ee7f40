# dart 6.20.0, ball, 2^-12 from zero: computeForwardDynamics, getBodyForce is imprecise (joint_wrenches at the accelerations that tau makes).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([-0.00022164861763099107, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
s.setPositions(q)
s.setVelocities(v)
s.setForces(tau)
s.setTimeStep(0.0)
s.computeForwardDynamics()
value = [np.roll(b.getBodyForce(), 3, axis=0) for b in links]
import numpy as np
value, expected = np.reshape(value, (1, 6))[(0, 1)], -0.002174372921156217
assert abs(value - expected) <= 1.7e-11, f"{value = }, {expected = }"
