# pinocchio 4.1.0, mimic revolute: getFrameJacobianTimeVariation is wrong (their time derivatives).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
s1 = pin.JointModelRY()
s1.setIndexes(j0, m.idx_qs[j0], m.idx_vs[j0])
j1 = m.addJoint(j0, pin.JointModelMimic(s1, 1.5, 0.0), pin.SE3(np.eye(3), np.eye(3)[1]), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0,
    pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
d = m.createData()
pin.computeJointJacobiansTimeVariation(m, d, np.zeros(1), np.array([1.0]))
pin.updateFramePlacements(m, d)
value = np.array([pin.getFrameJacobianTimeVariation(m, d, f, pin.LOCAL_WORLD_ALIGNED) for f in fs])
value, expected = np.array(value).reshape((2, 6, 1))[1, 0, 0], 0.0
assert abs(value - expected) <= 2.4e-12, f'value = {value!r}, expected = {expected!r}'
