# pinocchio 4.1.0, universal: getFrameAccelerationDerivatives is wrong (derivative of the accelerations by v).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
f = m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
d = m.createData()
pin.computeForwardKinematicsDerivatives(m, d, np.zeros(2), np.array([1.0, 1.0]), np.zeros(2))
pin.updateFramePlacements(m, d)
value, expected = pin.getFrameAccelerationDerivatives(m, d, f, pin.LOCAL)[2][5, 0], 1.0
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
