# pinocchio 4.1.0, universal: getCenterOfMassVelocityDerivatives is wrong (derivative of its velocity by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.eye(3)[0], np.eye(3)), pin.SE3.Identity())
d = m.createData()
pin.computeAllTerms(m, d, np.zeros(2), np.eye(2)[0])
value, expected = pin.getCenterOfMassVelocityDerivatives(m, d)[1, 1], 1.0
assert abs(value - expected) <= 1.9e-12, f'value = {value!r}, expected = {expected!r}'
