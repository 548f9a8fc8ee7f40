# dart 6.20.0, ball, 2^-12 from zero: getLinearAcceleration, of a point is imprecise (accelerations).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[0.16604955127564094, -0.0021910648220994406, -0.00018978885530024082], [-0.0021910648220994406, 0.13396756897168946, -9.226064123703189e-05], [-0.00018978885530024082, -9.226064123703189e-05, 0.16604497111634595]]))
links = [b0]
q = np.array([0.0002307611739667253, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
a = np.array([1.0, 0.0, 0.0])
s.setPositions(q)
s.setVelocities(v)
s.setAccelerations(a)
x, W = np.array([0.25, -0.5, 0.125]), dart.dynamics.Frame.World()
value = [b.getLinearAcceleration(x, W, W) for b in links]
import numpy as np
value, expected = np.reshape(value, (1, 3))[(0, 1)], -0.1248846160858707
assert abs(value - expected) <= 8.3e-13, f"{value = }, {expected = }"
