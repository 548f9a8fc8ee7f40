# pinocchio 4.1.0, base 10 km away: computeRNEADerivatives, getCoriolisMatrix is imprecise (C v = h - g, C the Coriolis matrix).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([6400.0, -4800.0, 6000.0])), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0])
v = np.array([0.3660092460559432])
a = np.array([0.0])
pin.computeRNEADerivatives(m, d, q, v, a)
value = pin.getCoriolisMatrix(m, d) @ v
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.0
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
