# pinocchio 4.1.0, point between branches: computeConstraintDynamicsDerivatives is wrong (derivative of constrained
# acceleration by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'a0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRY(), pin.SE3(np.eye(3), np.eye(3)[1]), 'a1')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'b0')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j3 = m.addJoint(j2, pin.JointModelRY(), pin.SE3(np.eye(3), np.eye(3)[1]), 'b1')
m.appendBodyToJoint(j3, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j1, pin.SE3.Identity(),
    j3, pin.SE3.Identity(), pin.LOCAL)])
d = m.createData()
v = np.array([0.009259259547809814, 0.0, 0.00925925954780982, 0.0])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.constraintDynamics(m, d, np.zeros(4), v, np.zeros(4), cm, cd, ps)
value, expected = pin.computeConstraintDynamicsDerivatives(m, d, cm, cd, ps)[0][0, 0], 4.286694368685366e-05
assert abs(value - expected) <= 1.5e-12, f'value = {value!r}, expected = {expected!r}'
