# pinocchio 4.1.0, chain 56: 0: translation, 0: mimic oblique beyond: data.M is wrong (M).
# Known: https://github.com/stack-of-tasks/pinocchio/pull/2716 (mends crba for several mimic joints, in 3.8.0; not this).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelTranslation(), pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
s2 = pin.JointModelRX()
s2.setIndexes(j0, m.idx_qs[j0], m.idx_vs[j0])
j2 = m.addJoint(j1, pin.JointModelMimic(s2, 2.0, 0.0), pin.SE3.Identity(), 'c0')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f2', j2, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1, j2]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 0.0])
pin.crba(m, d, q, pin.Convention.WORLD)
value = d.M
import numpy as np
value, expected = np.reshape(value, (4, 4))[(0, 3)], 0.0
assert abs(value - expected) <= 1.7e-11, f"{value = }, {expected = }"
