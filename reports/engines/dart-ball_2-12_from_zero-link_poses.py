# dart 6.20.0, ball, 2^-12 from zero: getTransform is imprecise (positions and rows of R).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([-0.00022164861763099107, 0.0, 0.0])
s.setPositions(q)
X = [b.getTransform() for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 8)], 0.00022164861581612814
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
