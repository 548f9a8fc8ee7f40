# dart 6.20.0, fixed links amid: getInvMassMatrix is wrong (M^-1).
import numpy as np, dartpy as dart
s = dart.dynamics.Skeleton('tree')
j, b0 = s.createRevoluteJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, np.zeros(3), np.eye(3)))
j, b1 = s.createWeldJointAndBodyNodePair(b0)
b1.setInertia(dart.dynamics.Inertia(1.0, np.zeros(3), np.eye(3)))
j, b2 = s.createRevoluteJointAndBodyNodePair(b1)
b2.setInertia(dart.dynamics.Inertia(1.0, np.zeros(3), np.eye(3)))
value, expected = s.getInvMassMatrix()[0, 1], -0.5
assert abs(value - expected) <= 2.1e-12, f'value = {value!r}, expected = {expected!r}'
