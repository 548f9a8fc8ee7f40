# pinocchio 4.1.0, universal: computeABADerivatives is wrong (derivative of forward dynamics by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.eye(3)[0], np.eye(3)), pin.SE3.Identity())
value, expected = pin.computeABADerivatives(m, m.createData(), np.zeros(2), np.eye(2)[0], np.zeros(2))[0][1, 1], 0.5
assert abs(value - expected) <= 4.9e-12, f'value = {value!r}, expected = {expected!r}'
