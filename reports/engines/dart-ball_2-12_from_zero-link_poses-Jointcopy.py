# dart 6.20.0, ball, 2^-12 from zero: Joint.copy, getTransform is imprecise (positions and rows of R).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0002307611739667253, 0.0, 0.0])
if globals().get('made_by') != 'Joint.copy':
    made_by = 'Joint.copy'
    first, s = s, s.clone()
    links = [s.getBodyNode(b.getName()) for b in links]
    for k in range(s.getNumJoints()):
        j = s.getJoint(k)
        if hasattr(j, 'copy'):
            j.setTransformFromParentBodyNode(dart.math.Isometry3(np.eye(3), np.array([1.0, -2.0, 0.5])))
            for name, axis in (('setAxis', (0.0, 0.6, 0.8)), ('setAxis1', (0.0, 0.6, 0.8)), ('setAxis2', (0.8, 0.0, 0.6))):
                if hasattr(j, name): getattr(j, name)(np.array(axis))
            j.copy(first.getJoint(k))
s.setPositions(q)
X = [b.getTransform() for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 8)], -0.00023076117191869224
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
