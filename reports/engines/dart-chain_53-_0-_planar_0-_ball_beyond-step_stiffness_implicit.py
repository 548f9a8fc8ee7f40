# dart 6.20.0, chain 53: 0: planar, 0: ball beyond: World.step is imprecise (q+, v+ (nq + nv) after a step: v+ = v + h (M + h D + h^2 K)^-1 (f - h K v)).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createRevoluteJointAndBodyNodePair(None)
j.setAxis([1.0, 0.0, 0.0])
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b1 = s.createPlanarJointAndBodyNodePair(b0)
j.setXYPlane()
j.setTransformFromParentBodyNode(dart.math.Isometry3([[-0.3095418376650947, 0.8010368826463513, 0.5123707284526817], [-0.8033398235192428, -0.5085929055238099, 0.3098037837065921], [0.5087523746214734, -0.31571057804746516, 0.8009356105367943]], [0.0, 0.0, 0.0]))
b1.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
j, b2 = s.createBallJointAndBodyNodePair(b1)
j.setTransformFromParentBodyNode(dart.math.Isometry3([[-0.7295985704729896, 0.6256977812348072, 0.2760221232466872], [-0.2763615216107727, -0.6389466923667236, 0.7178937481874332], [0.6255479480717273, 0.447492358450357, 0.6390933842497423]], [0.0, 0.0, 0.0]))
b2.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0, b1, b2]
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3])
v = np.array([-89.0, 0.0, 0.0, -99.0, 0.0, -82.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
import numpy as np
w = dart.simulation.World()
w.setGravity(s.getGravity()); w.addSkeleton(s); w.setTimeStep(0.015625)
s.setPositions(q)
s.setVelocities(v)
s.setForces(tau)
w.step()
def near(x, place):
    for j in map(s.getJoint, range(s.getNumJoints())):
        if j.getType() in ('BallJoint', 'FreeJoint'):
            k = j.getIndexInSkeleton(0)
            r = x[k:k + 3]
            n = np.linalg.norm(r) or 1.0
            r += 2 * np.pi * np.round((place[k:k + 3] @ r / n - n) / (2 * np.pi)) * r / n
    return x
x, reached, speeds = q, s.getPositions(), s.getVelocities()
s.setPositions(q)
for _ in range(64):
    s.setVelocities(speeds)
    s.integratePositions(0.015625 / 64)
    x = near(s.getPositions(), x)
value = np.r_[near(reached, x), speeds]
import numpy as np
value, expected = np.reshape(value, (14,))[(5,)], -1.4310972209508375
assert abs(value - expected) <= 6.3e-10, f"{value = }, {expected = }"
