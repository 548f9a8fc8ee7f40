# pinocchio 4.1.0, point between branches: computeDelassusMatrix is wrong (J M^-1 J^T).
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
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
value, expected = pin.computeDelassusMatrix(m, d, np.zeros(4), cm, cd, 0.0)[2, 2], 0.6666666666666666
assert abs(value - expected) <= 7.8e-13, f'value = {value!r}, expected = {expected!r}'
