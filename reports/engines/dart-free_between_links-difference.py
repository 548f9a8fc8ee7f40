# dart 6.20.0, free between links: getPositionDifferences is wrong (v2, of q and where v2 leads from it).
import numpy as np, dartpy as dart
s = dart.dynamics.Skeleton('tree')
j, b0 = s.createFreeJointAndBodyNodePair(None)
j.setTransformFromParentBodyNode(dart.math.Isometry3([np.eye(3)[2], np.eye(3)[0], np.eye(3)[1]], np.zeros(3)))
b0.setInertia(dart.dynamics.Inertia(1.0, np.zeros(3), np.eye(3)))
q = np.eye(6)[5]
s.setPositions(q)
s.setVelocities(np.eye(6)[5])
s.integratePositions(1.0)
value, expected = s.getPositionDifferences(s.getPositions(), q)[4], 0.0
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
