# pinocchio 4.1.0, universal: dccrba is wrong (dA/dt).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
value, expected = pin.dccrba(m, m.createData(), np.zeros(2), np.array([1.0, 1.0]))[5, 0], 0.0
assert abs(value - expected) <= 1.9e-12, f'value = {value!r}, expected = {expected!r}'
