# pinocchio 4.1.0, universal: computeABADerivatives is wrong (derivative of forward dynamics by v).
import numpy as np
import pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[1]), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.zeros(3), np.diag([2.0, 3.0, 4.0])), pin.SE3.Identity())
d = m.createData()
q, v, tau = np.array([0.0, 1.0]), np.array([1.0, 1.0]), np.zeros(2)
value, expected = pin.computeABADerivatives(m, d, q, v, tau)[1][0, 0], -0.5323526594920907
assert abs(value - expected) <= 1.8e-12, f"{value = }, {expected = }"
