# pinocchio 4.1.0, point beyond a universal joint: computeConstraintDynamicsDerivatives is wrong (derivative of
# constrained acceleration by v).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'a0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3(np.eye(3), np.eye(3)[1]), 'a1')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(j1, pin.JointModelRZ(), pin.SE3.Identity(), 'a2')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j3 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'b0')
m.appendBodyToJoint(j3, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j4 = m.addJoint(j3, pin.JointModelRY(), pin.SE3(np.eye(3), np.eye(3)[1]), 'b1')
m.appendBodyToJoint(j4, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j1, pin.SE3.Identity(),
    j4, pin.SE3.Identity(), pin.LOCAL)])
d = m.createData()
v = np.array([0.0, 0.013920974055887436, -0.7869367595505089, 0.0, 0.0, 0.0])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.constraintDynamics(m, d, np.zeros(6), v, np.zeros(6), cm, cd, ps)
value, expected = pin.computeConstraintDynamicsDerivatives(m, d, cm, cd, ps)[1][3, 1], 0.7869367595505089
assert abs(value - expected) <= 1.8e-12, f'value = {value!r}, expected = {expected!r}'
