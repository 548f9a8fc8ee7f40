"""pinocchio 4.1.0: getFrameAccelerationDerivatives, universal.

Result: derivative of the accelerations by v (L, 6, nv).
Known: none found.
"""

import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.zeros(3)
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
fs = []
fs.append(m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)))
d = m.createData()
q = np.array([0.0, 0.0])
v = np.array([0.0, 1.0])
a = np.array([0.0, 0.0])
pin.computeForwardKinematicsDerivatives(m, d, q, v, a)
pin.updateFramePlacements(m, d)
value = np.array([pin.getFrameAccelerationDerivatives(m, d, f, pin.WORLD)[2] for f in fs])
value = np.array(value, dtype=float)
expected = np.array([[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.4e-12
