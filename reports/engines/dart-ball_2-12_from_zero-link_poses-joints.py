# dart 6.20.0, ball, 2^-12 from zero: getRelativeTransform, getRelativeJacobian is imprecise (positions and rows of R).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createBallJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0002307611739667253, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
a = np.array([0.0, 0.0, 0.0])
s.setPositions(q); s.setVelocities(v); s.setAccelerations(a)
def moved(X, t):
    R, p = X.rotation(), X.translation()
    return np.concatenate([R.T @ t[:3], R.T @ (t[3:] + np.cross(t[:3].T, p).T)])
start, found = (np.zeros(6), np.zeros(6), np.zeros((6, len(v))), np.eye(3), np.zeros(3)), {}
for b in links:
    j, parent = b.getParentJoint(), b.getParentBodyNode()
    V, A, J, R, p = found[parent.getName()] if parent else start
    own = [j.getIndexInSkeleton(k) for k in range(j.getNumDofs())]
    X, S, rate = j.getRelativeTransform(), np.zeros((6, len(v))), np.zeros((6, len(v)))
    S[:, own], rate[:, own] = j.getRelativeJacobian(), j.getRelativeJacobianTimeDeriv()
    V, step = moved(X, V) + j.getRelativeSpatialVelocity(), j.getRelativeSpatialVelocity()
    turning = np.r_[np.cross(V[:3], step[:3]), np.cross(V[3:], step[:3]) + np.cross(V[:3], step[3:])]
    A = moved(X, A) + turning + rate @ v + S @ a
    found[b.getName()] = (V, A, moved(X, J) + S, R @ X.rotation(), p + R @ X.translation())
V, A, J, R, p = zip(*(found[b.getName()] for b in links))
value = [[*at, *turn.flat] for at, turn in zip(p, R)]
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 8)], -0.00023076117191869224
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
