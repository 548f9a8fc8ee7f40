# pinocchio 4.1.0, point beyond a universal joint: computeConstraintDynamicsDerivatives is wrong (derivative of
# constraint forces by v).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3(np.eye(3), np.eye(3)[0]), 'a1')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRY(), pin.SE3(np.eye(3), np.eye(3)[1]), 'a2')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.eye(3), np.eye(3)[2]), 'b0')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j3 = m.addJoint(j2, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'b1')
m.appendBodyToJoint(j3, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j1, pin.SE3.Identity(),
    j3, pin.SE3(np.eye(3), np.eye(3)[2]), pin.LOCAL)])
d = m.createData()
q = np.array([2.6179938779914944, 1.5047535652552575e-16, 0.0, 3.4995841907867136e-28, 2.0943951023931957])
v = np.array([-5.826178258151715e-17, 0.0, 0.0, 1.1102230246251565e-16, -5.826178258151715e-17])
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings(1e-14, 1e-12, 20)
pin.initConstraintDynamics(m, d, cm, cd)
value = pin.constraintDynamics(m, d, q, v, np.zeros(5), cm, cd, ps)
value, expected = pin.computeConstraintDynamicsDerivatives(m, d, cm, cd, ps)[4][0, 1], 0.0
assert abs(value - expected) <= 8.1e-27, f'value = {value!r}, expected = {expected!r}'
