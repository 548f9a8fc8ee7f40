# pinocchio 4.1.0, ball: getFrameAccelerationDerivatives is wrong (derivative of the accelerations by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelSpherical(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
f = m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
d = m.createData()
pin.computeForwardKinematicsDerivatives(m, d, np.eye(5)[4], np.eye(4)[3], np.zeros(4))
pin.updateFramePlacements(m, d)
value, expected = pin.getFrameAccelerationDerivatives(m, d, f, pin.WORLD)[1][3, 1], 0.0
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
