# pinocchio 4.1.0, mimic revolute: getFrameJacobianTimeVariation is wrong (their time derivatives).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
s1 = pin.JointModelRY()
s1.setIndexes(j0, m.idx_qs[j0], m.idx_vs[j0])
j1 = m.addJoint(j0, pin.JointModelMimic(s1, 1.5, 0.0), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(j1, pin.JointModelRX(), pin.SE3.Identity(), 'c')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
f = m.addFrame(pin.Frame('f2', j2, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
d = m.createData()
pin.computeJointJacobiansTimeVariation(m, d, np.zeros(2), np.eye(2)[1])
pin.updateFramePlacements(m, d)
value, expected = pin.getFrameJacobianTimeVariation(m, d, f, pin.LOCAL)[5, 0], -1.5
assert abs(value - expected) <= 2.8e-12, f'value = {value!r}, expected = {expected!r}'
