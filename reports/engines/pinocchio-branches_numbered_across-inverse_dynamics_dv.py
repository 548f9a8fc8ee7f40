# pinocchio 4.1.0, branches, numbered across: computeRNEADerivatives is wrong (derivative of M a + h by v).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/1897.
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'f')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j2 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3(np.eye(3), np.eye(3)[0]), 'e')
m.appendBodyToJoint(j2, pin.Inertia(1.0, np.eye(3)[0], np.eye(3)), pin.SE3.Identity())
q, v = np.eye(3)[2], np.eye(3)[2]
value, expected = pin.computeRNEADerivatives(m, m.createData(), q, v, np.zeros(3))[1][0, 2], -1.682941969615793
assert abs(value - expected) <= 2.4e-12, f'value = {value!r}, expected = {expected!r}'
