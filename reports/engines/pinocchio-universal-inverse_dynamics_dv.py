# pinocchio 4.1.0, universal: computeRNEADerivatives is wrong (derivative of M a + h by v).
import numpy as np
import pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.diag([2.0, 3.0, 4.0])), pin.SE3.Identity())
d = m.createData()
q, v, a = np.array([0.0, 1.0]), np.array([1.0, 1.0]), np.zeros(2)
value, expected = pin.computeRNEADerivatives(m, d, q, v, a)[1][0, 0], 1.8185948536513634
assert abs(value - expected) <= 6.9e-12, f"{value = }, {expected = }"
