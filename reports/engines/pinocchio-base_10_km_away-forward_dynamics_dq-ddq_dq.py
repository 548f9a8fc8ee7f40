# pinocchio 4.1.0, base 10 km away: data.ddq_dq is imprecise (derivative of forward dynamics by q).
import numpy as np
import pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([6400.0, -4800.0, 6000.0])), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.8187017420963922, np.array([1.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([1.0])
v = np.array([0.0])
tau = np.array([0.0])
pin.computeABADerivatives(m, d, q, v, tau)
value = d.ddq_dq
import numpy as np
value, expected = np.reshape(value, (1, 1))[(0, 0)], 5.326237300663177
assert abs(value - expected) <= 1.5e-08, f"{value = }, {expected = }"
