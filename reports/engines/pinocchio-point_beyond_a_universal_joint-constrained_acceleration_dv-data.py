# pinocchio 4.1.0, point beyond a universal joint: data.ddq_dv is wrong (derivative of constrained acceleration by v).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'a2')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'b1')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j0, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([0.0, 1.0, 0.0])), j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), pin.LOCAL)])
am = pin.StdVec_ConstraintModel([pin.ConstraintModel(pin.PointAnchorConstraintModel(m, j0, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([0.0, 1.0, 0.0])), j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0]))))])
d = m.createData()
q = np.array([-1.8483147424710373, -0.27751841567614066])
v = np.array([-0.4033460556699371, -0.4033460556699373])
tau = np.array([0.0, 0.0])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.constraintDynamics(m, d, q, v, tau, cm, cd, ps)
value = pin.computeConstraintDynamicsDerivatives(m, d, cm, cd, ps)
value = d.ddq_dv
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 0)], 0.0
assert abs(value - expected) <= 8.3e-13, f"{value = }, {expected = }"
