# pinocchio 4.1.0, point between branches: impulseDynamics, LOCAL_WORLD_ALIGNED is wrong (speeds after impact: M (v+ - v2) = J^T impulse, J v+ = -J v2 / 2).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), 'a2')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'b2')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j0, pin.SE3.Identity(), j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), pin.LOCAL_WORLD_ALIGNED)])
am = pin.StdVec_ConstraintModel([pin.ConstraintModel(pin.PointAnchorConstraintModel(m, j0, pin.SE3.Identity(), j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0]))))])
d = m.createData()
q = np.array([-1.237716704978997, -1.3234889800848443e-23])
v2 = np.array([0.0, 1.0])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.impulseDynamics(m, d, q, v2, cm, cd, 0.5, ps)
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -0.5
assert abs(value - expected) <= 5.0e-10, f"{value = }, {expected = }"
