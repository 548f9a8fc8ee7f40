# pinocchio 4.1.0, point beyond a universal joint: data.dlambda_dv is wrong (derivative of constraint forces by v).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelUniversal(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])), pin.SE3.Identity(), 'a1')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3.Identity(), 'a2')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j2 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), 'b1')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f2', j2, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1, j2]
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([0.0, 1.0, 0.0])), j2, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), pin.LOCAL)])
am = pin.StdVec_ConstraintModel([pin.ConstraintModel(pin.PointAnchorConstraintModel(m, j1, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([0.0, 1.0, 0.0])), j2, pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0]))))])
d = m.createData()
q = np.array([-4.447889593663068, -1.0317368303803989, -1.3424145240860548, -2.0943951023931957])
v = np.array([0.2459019525958126, 0.029340214874068887, 0.21103105129574679, 6.976564436438899e-18])
tau = np.array([0.0, 0.0, 0.0, 0.0])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.constraintDynamics(m, d, q, v, tau, cm, cd, ps)
value = pin.computeConstraintDynamicsDerivatives(m, d, cm, cd, ps)
value = d.dlambda_dv
import numpy as np
value, expected = np.reshape(value, (3, 4))[(2, 1)], -0.15591287094394682
assert abs(value - expected) <= 1.3e-12, f"{value = }, {expected = }"
