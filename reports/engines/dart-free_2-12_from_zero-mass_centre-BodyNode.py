# dart 6.20.0, free, 2^-12 from zero: BodyNode.getCOM is imprecise (mass centre).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createFreeJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [1.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0, 0.0, 0.0002307611739667253, -5.660976122187492e-05, 0.00010722927130545209, 6.4927237579656466e-06])
s.setPositions(q)
m = np.array([b.getMass() for b in links])
value = m @ [b.getCOM() for b in links] / s.getMass()
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], 0.0003379904432241443
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
