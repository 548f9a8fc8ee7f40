# pinocchio 4.1.0, chain 56: 0: translation, 0: mimic oblique beyond: frameJacobianTimeVariation is wrong (their time derivatives).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelTranslation(), pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
s2 = pin.JointModelRZ()
s2.setIndexes(j0, m.idx_qs[j0], m.idx_vs[j0])
j2 = m.addJoint(j1, pin.JointModelMimic(s2, 2.0, 0.0), pin.SE3.Identity(), 'c0')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f2', j2, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1, j2]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 1.0, 0.0])
value = [pin.frameJacobianTimeVariation(m, d, q, v, f, pin.LOCAL) for f in fs]
import numpy as np
value, expected = np.reshape(value, (3, 6, 4))[(2, 0, 0)], -1.0
assert abs(value - expected) <= 1.9e-12, f"{value = }, {expected = }"
