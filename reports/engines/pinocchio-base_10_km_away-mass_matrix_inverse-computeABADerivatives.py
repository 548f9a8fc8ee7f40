# pinocchio 4.1.0, base 10 km away: computeABADerivatives is imprecise (M^-1).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[-0.022500291568026905, 0.975816140144018, 0.21743182267962521], [-0.27506996321534877, 0.20305028385882, -0.9397377812781389], [-0.9611608877893755, -0.08095333754257956, 0.26384901918456455]]), np.array([6400.0, -4800.0, 6000.0])), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([0.0])
value = pin.computeABADerivatives(m, d, q, v, tau)[2]
import numpy as np
value, expected = np.reshape(value, (1, 1))[(0, 0)], 1.0
assert abs(value - expected) <= 1.8e-12, f"{value = }, {expected = }"
