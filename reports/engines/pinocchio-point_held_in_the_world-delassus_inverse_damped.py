# pinocchio 4.1.0, point held in the world: computeDampedDelassusMatrixInverse is wrong ((J M^-1 J^T + 1e-4)^-1).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[0]), 'a0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRY(), pin.SE3(np.eye(3), np.eye(3)[1]), 'a1')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(j1, pin.JointModelRZ(), pin.SE3(np.eye(3), np.eye(3)[2]), 'a2')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
cm = pin.StdVec_RigidConstraintModel([pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, m, j2, pin.SE3.Identity(), 0,
    pin.SE3(np.eye(3), np.array([1.0, 1.0, 1.0])), pin.LOCAL)])
d = m.createData()
cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
value, expected = (pin.computeDampedDelassusMatrixInverse(m, d, np.zeros(3), cm, cd, 0.0001, True) / 0.0001)[0,
    0], 2.9991002699190243
assert abs(value - expected) <= 0.0005, f'value = {value!r}, expected = {expected!r}'
