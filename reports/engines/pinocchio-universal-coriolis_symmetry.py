# pinocchio 4.1.0, universal: computeCoriolisMatrix is wrong (C + C^T = dM/dt).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.diag([2.0, 3.0, 4.0])), pin.SE3.Identity())
C = pin.computeCoriolisMatrix(m, m.createData(), np.eye(2)[1], np.array([1.0, 1.0]))
value, expected = (C + C.T)[0, 0], 1.8185948536513634
assert abs(value - expected) <= 5e-12, f'value = {value!r}, expected = {expected!r}'
