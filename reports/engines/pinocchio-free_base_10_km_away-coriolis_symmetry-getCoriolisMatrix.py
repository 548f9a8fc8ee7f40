# pinocchio 4.1.0, free base 10 km away: computeRNEADerivatives, getCoriolisMatrix is imprecise (C + C^T = dM/dt).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRX(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 1.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 0.0, 5999.0, 0.0, 0.0, 0.0, 1.0, -2.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
pin.computeRNEADerivatives(m, d, q, v, a)
C = pin.getCoriolisMatrix(m, d)
value = C + C.T
import numpy as np
value, expected = np.reshape(value, (7, 7))[(4, 5)], 0.6536436208636119
assert abs(value - expected) <= 1.9e-09, f"{value = }, {expected = }"
