# dart 6.20.0, ball, 2^-12 from zero: clone, computeForwardDynamics is imprecise (M^-1 (tau - h)).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createRevoluteJointAndBodyNodePair(b0)
b1.setInertia(dart.dynamics.Inertia(1.0, [1.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1]
q = np.array([-0.00022164861763099107, 0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0])
if globals().get('made_by') != 'clone':
    made_by = 'clone'
    s = s.clone()
    links = [s.getBodyNode(b.getName()) for b in links]
s.setPositions(q)
s.setVelocities(v)
s.setForces(tau)
s.setTimeStep(0.0)
s.computeForwardDynamics()
value = s.getAccelerations()
import numpy as np
value, expected = np.reshape(value, (4,))[(3,)], 0.0010871864605781086
assert abs(value - expected) <= 5.7e-12, f"{value = }, {expected = }"
