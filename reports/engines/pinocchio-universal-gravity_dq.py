# pinocchio 4.1.0, universal: computeGeneralizedGravityDerivatives is wrong (derivative of g by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.eye(3)[0], np.eye(3)), pin.SE3.Identity())
value, expected = pin.computeGeneralizedGravityDerivatives(m, m.createData(), np.eye(2)[0])[0, 1], 8.254830360965466
assert abs(value - expected) <= 2e-11, f'value = {value!r}, expected = {expected!r}'
