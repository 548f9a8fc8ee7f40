"""dart 6.20.0: getInvMassMatrix, fixed links amid.

Result: M^-1 (nv, nv).
Known: none found.
"""

import numpy as np
import dartpy as dart
dy = dart.dynamics
def state(q, v=None, a=None):
    s.setPositions(q)
    s.setVelocities(np.zeros(len(q)) if v is None else v)
    s.setAccelerations(np.zeros(len(q)) if a is None else a)
W = dy.Frame.World()
s = dy.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createRevoluteJointAndBodyNodePair(None)
j.setAxis([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])
b0.setInertia(dy.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createWeldJointAndBodyNodePair(b0)
b1.setInertia(dy.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b2 = s.createRevoluteJointAndBodyNodePair(b1)
j.setAxis([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])
b2.setInertia(dy.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1, b2]
q = np.array([0.0, 0.0])
state(q)
value = s.getInvMassMatrix()
value = np.array(value, dtype=float)
expected = np.array([[0.5, -0.5], [-0.5, 1.5]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.3e-12
