# dart 6.20.0, ball, 2^-12 from zero: DegreeOfFreedom.setPosition is imprecise (positions and rows of R).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0002307611739667253, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
for k in range(s.getNumDofs()): s.getDof(k).setPosition(q[k]); s.getDof(k).setVelocity(v[k])
X = [b.getTransform() for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 8)], -0.00023076117191869224
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
