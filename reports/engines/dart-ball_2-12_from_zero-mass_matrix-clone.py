# dart 6.20.0, ball, 2^-12 from zero: clone, getMassMatrix is imprecise (M).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createRevoluteJointAndBodyNodePair(None)
j.setAxis([1.0, 0.0, 0.0])
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createBallJointAndBodyNodePair(b0)
j.setTransformFromParentBodyNode(dart.math.Isometry3([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0.0, 0.0, 0.0]))
b1.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b2 = s.createRevoluteJointAndBodyNodePair(b1)
j.setAxis([1.0, 0.0, 0.0])
b2.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1, b2]
q = np.array([0.0, 0.0002307611739667253, 0.0, 0.00010722927130545209, 0.0])
if globals().get('made_by') != 'clone':
    made_by = 'clone'
    s = s.clone()
    links = [s.getBodyNode(b.getName()) for b in links]
s.setPositions(q)
value = s.getMassMatrix()
import numpy as np
value, expected = np.reshape(value, (5, 5))[(0, 2)], 0.0004615223429529448
assert abs(value - expected) <= 4.4e-12, f"{value = }, {expected = }"
