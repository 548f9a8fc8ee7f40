# pinocchio 4.1.0, universal: computeCentroidalDynamicsDerivatives is wrong (derivative of d(A v)/dt by q).
import numpy as np, pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.eye(3)), pin.SE3.Identity())
v = np.array([1.0, 1.0])
value, expected = pin.computeCentroidalDynamicsDerivatives(m, m.createData(), np.zeros(2), v, np.zeros(2))[1][3, 1], 0.0
assert abs(value - expected) <= 2.8e-12, f'value = {value!r}, expected = {expected!r}'
