# dart 6.20.0, free, 2^-12 from zero: getCOM is imprecise (mass centre).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createFreeJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [1.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createRevoluteJointAndBodyNodePair(b0)
b1.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1]
q = np.array([-0.0001871290481108382, 0.0, 0.0002307611739667253, -5.660976122187492e-05, 0.00010722927130545209, 6.4927237579656466e-06, 0.00019195674440283838])
s.setPositions(q)
value = s.getCOM()
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], 0.0002226098565914125
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
