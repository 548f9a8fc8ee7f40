# pinocchio 4.1.0, point between branches: computeImpulseDynamicsDerivatives is wrong (derivative of the speeds after
# impact by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'a0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRY(), pin.SE3(np.eye(3), np.eye(3)[1]), 'a1')
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
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.impulseDynamics(m, d, np.zeros(5), np.eye(5)[3], cm, cd, 0.0, ps)
pin.computeImpulseDynamicsDerivatives(m, d, cm, cd, 0.0, ps)
value, expected = d.ddq_dq[2, 1], -0.375
assert abs(value - expected) <= 3.8e-10, f'value = {value!r}, expected = {expected!r}'
