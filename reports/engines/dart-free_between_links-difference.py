"""dart 6.20.0: getPositionDifferences, free between links.

Result: v2, of q and where v2 leads from it (nv).
Known: none found.
"""

import numpy as np
import dartpy as dart
dy = dart.dynamics
def iso(R, p):
    X = dart.math.Isometry3()
    X.set_rotation(np.array(R))
    X.set_translation(np.array(p))
    return X
def state(q, v=None, a=None):
    s.setPositions(q)
    s.setVelocities(np.zeros(len(q)) if v is None else v)
    s.setAccelerations(np.zeros(len(q)) if a is None else a)
W = dy.Frame.World()
s = dy.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createFreeJointAndBodyNodePair(None)
j.setTransformFromParentBodyNode(iso([[-0.26529991822610355, 0.013803312672644874, -0.9640671252296098], [-0.535560800480858, -0.83356416652579, 0.13544522609700074], [-0.8017422169111001, 0.5522501687128997, 0.22853701839975143]], [0.0, 0.0, 0.0]))
b0.setInertia(dy.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
state(q, v2)
s.integratePositions(1.0)
value = s.getPositionDifferences(s.getPositions(), q)
value = np.array(value, dtype=float)
expected = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.4e-12
