# dart 6.20.0, chain 2: oblique gravity, free base, 0: prismatic oblique, 0: prismatic oblique beyond, 0: mass at the origin, 0: at the origin: World.step is imprecise (q+, v+ (nq + nv) after a step: v+ = v + h (M + h D + h^2 K)^-1 (f - h K v)).
import numpy as np
import dartpy as dart
s = dart.dynamics.Skeleton('tree')
s.setGravity([0.0, 0.0, 0.0])
j, b0 = s.createFreeJointAndBodyNodePair(None)
b0.setInertia(dart.dynamics.Inertia(1.0, [0.0, 0.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
links = [b0]
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
import numpy as np
w = dart.simulation.World()
w.setGravity(s.getGravity()); w.addSkeleton(s); w.setTimeStep(0.015625)
s.setPositions(q)
s.setVelocities(v)
s.setForces(tau)
w.step()
value = np.r_[s.getPositions(), s.getVelocities()]
import numpy as np
value, expected = np.reshape(value, (12,))[(2,)], 0.000244140625
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
