# dart 6.20.0, ball, 2^-12 from zero: getLinearJacobian, getAngularJacobian is imprecise (Jacobians of the links).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0002307611739667253, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0])
s.setPositions(q); s.setVelocities(v); s.setAccelerations(a)
W = dart.dynamics.Frame.World()
value = [np.r_[s.getLinearJacobian(b, W), s.getAngularJacobian(b, W)] for b in links]
import numpy as np
value, expected = np.reshape(value, (1, 6, 3))[(0, 4, 2)], -0.00023076117191869224
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
