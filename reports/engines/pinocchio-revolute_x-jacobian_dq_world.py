# pinocchio 4.1.0, revolute x: getJointKinematicHessian is wrong (their derivatives by q).
# Known: https://github.com/stack-of-tasks/eigenpy/issues/557.
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRX(), pin.SE3(np.eye(3), np.eye(3)[1]), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
d = m.createData()
pin.computeJointJacobians(m, d, np.zeros(2))
pin.computeJointKinematicHessians(m, d)
value, expected = pin.getJointKinematicHessian(m, d, j1, pin.WORLD)[1, 1, 0], 1.0
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
