# dart 6.20.0, ball, 2^-12 from zero: getTransform, withRespectTo is imprecise (positions and rows of R in the first link).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createRevoluteJointAndBodyNodePair(None)
j.setAxis([1.0, 0.0, 0.0])
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createBallJointAndBodyNodePair(b0)
b1.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1]
q = np.array([-0.0002684619596799813, -0.00022164861763099107, 1.3247081085311998e-05, -5.322163548386431e-05])
s.setPositions(q)
A = links[0]
X = [b.getTransform(A) for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
import numpy as np
value, expected = np.reshape(value, (2, 12))[(1, 10)], -0.00022164896822066612
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
