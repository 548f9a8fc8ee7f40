# dart 6.20.0, chain 55: 0: free between links, 0: turned, 0: revolute oblique beyond: getPositionDifferences is wrong (v2, of q and where v2 leads from it).
# Known: https://github.com/dartsim/dart/pull/2298 (changed integratePositions of such joints).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createFreeJointAndBodyNodePair(None)
j.setTransformFromParentBodyNode(dart.math.Isometry3([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0.0, 0.0, 0.0]))
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
s.setPositions(q)
s.setVelocities(v2)
s.integratePositions(1.0)
value = s.getPositionDifferences(s.getPositions(), q)
import numpy as np
value, expected = np.reshape(value, (6,))[(4,)], 0.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
