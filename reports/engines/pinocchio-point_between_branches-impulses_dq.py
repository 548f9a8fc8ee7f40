# pinocchio 4.1.0, point between branches: computeImpulseDynamicsDerivatives is wrong (derivative of the impulses by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRY(), pin.SE3(np.array([np.eye(3)[2], np.eye(3)[0], np.eye(3)[1]]), np.zeros(3)),
    'a1')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(j1, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'a2')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j3 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.eye(3), np.eye(3)[0]), 'b2')
m.appendBodyToJoint(j3, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j2, pin.SE3.Identity(),
    j3, pin.SE3(np.eye(3), np.eye(3)[1]), pin.LOCAL)])
d = m.createData()
q = np.array([-3.088813510442863e-43, -0.5235987755982988, 0.0, 0.5235987755982988])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.impulseDynamics(m, d, q, np.eye(4)[3], cm, cd, 0.0, ps)
pin.computeImpulseDynamicsDerivatives(m, d, cm, cd, 0.0, ps)
value, expected = d.dlambda_dq[0, 1], -0.6666666666666669
assert abs(value - expected) <= 6.7e-10, f'value = {value!r}, expected = {expected!r}'
