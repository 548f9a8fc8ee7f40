# pinocchio 4.1.0, four-bar in a plane: forwardDynamics is wrong (a: M a + h = tau + J^T f, J a + J' v = 0).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRY(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), 'c')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), 0, pin.SE3.Identity(), pin.LOCAL)])
am = pin.StdVec_ConstraintModel([pin.ConstraintModel(pin.PointAnchorConstraintModel(m, j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), 0, pin.SE3.Identity()))])
d = m.createData()
q = np.array([1.1345055985089871, -3.141592653589793])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 1.0])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.constraintDynamics(m, d, q, v, tau, cm, cd, ps)
bound = value.copy()
free = pin.aba(m, d, q, v, tau).copy()
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
pin.computeJointJacobians(m, d, q)
for one, data in zip(cm, cd): one.calc(m, d, data)
J = pin.getConstraintsJacobian(m, d, cm, cd)
g = J @ (free - bound)
value = pin.forwardDynamics(m, d, q, v, tau, J, -J @ bound, 0.0)
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 0.0
assert abs(value - expected) <= 7.8e-13, f"{value = }, {expected = }"
