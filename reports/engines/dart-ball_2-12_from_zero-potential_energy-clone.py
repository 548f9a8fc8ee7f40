# dart 6.20.0, ball, 2^-12 from zero: clone, computePotentialEnergy is imprecise (V = -sum m g^T p, and what springs store).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createRevoluteJointAndBodyNodePair(b0)
j.setTransformFromParentBodyNode(dart.math.Isometry3([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0.0, 1.0, 0.0]))
b1.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1]
q = np.array([0.0002307611739667253, 0.0, 0.0, 0.0])
if globals().get('made_by') != 'clone':
    made_by = 'clone'
    s = s.clone()
    links = [s.getBodyNode(b.getName()) for b in links]
s.setPositions(q)
value = s.computePotentialEnergy()
import numpy as np
value, expected = np.reshape(value, ())[()], 0.0022637670965223707
assert abs(value - expected) <= 1.4e-11, f"{value = }, {expected = }"
