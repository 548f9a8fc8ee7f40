# dart 6.20.0, ball, 2^-12 from zero: getLinearJacobian, of a point is imprecise (Jacobians).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[0.16604955127564094, -0.0021910648220994406, -0.00018978885530024082], [-0.0021910648220994406, 0.13396756897168946, -9.226064123703189e-05], [-0.00018978885530024082, -9.226064123703189e-05, 0.16604497111634595]]))
links = [b0]
q = np.array([-0.00022164861763099107, 0.0, 0.0])
s.setPositions(q)
x, W = np.array([0.25, -0.5, 0.125]), dart.dynamics.Frame.World()
value = [s.getLinearJacobian(b, x, W) for b in links]
import numpy as np
value, expected = np.reshape(value, (1, 3, 3))[(0, 1, 0)], -0.12511082123740122
assert abs(value - expected) <= 5.0e-13, f"{value = }, {expected = }"
