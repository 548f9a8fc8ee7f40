# dart 6.20.0, free base with branches: World.step is imprecise (q+, v+ (nq + nv) after a step: v+ = v + h (M + h D + h^2 K)^-1 (f - h K v)).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createFreeJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[0.1553797542131575, -0.0044451811542391174, 0.01241527632493358], [-0.0044451811542391174, 0.17112054821288586, 0.0015728855041406767], [0.01241527632493358, 0.0015728855041406767, 0.16062372850165374]]))
j, b1 = s.createRevoluteJointAndBodyNodePair(b0)
b1.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[0.13073271547516088, 0.01318933932128986, 0.012090163518589356], [0.01318933932128986, 0.1366684854328218, -0.010333015122841696], [0.012090163518589356, -0.010333015122841696, 0.13406349641947957]]))
links = [b0, b1]
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5])
import numpy as np
w = dart.simulation.World()
w.setGravity(s.getGravity()); w.addSkeleton(s); w.setTimeStep(0.015625)
s.setPositions(q)
s.setVelocities(v)
s.setForces(tau)
w.step()
value = np.r_[s.getPositions(), s.getVelocities()]
import numpy as np
value, expected = np.reshape(value, (14,))[(2,)], -0.0007597986992147298
assert abs(value - expected) <= 7.7e-13, f"{value = }, {expected = }"
