# pinocchio 4.1.0, universal: computeCoriolisMatrix is wrong (C v = h - g, C the Coriolis matrix).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.diag([2.0, 3.0, 4.0])), pin.SE3.Identity())
v = np.array([1.0, 1.0])
value, expected = (pin.computeCoriolisMatrix(m, m.createData(), np.eye(2)[1], v) @ v)[0], 1.8185948536513634
assert abs(value - expected) <= 5.1e-12, f'value = {value!r}, expected = {expected!r}'
