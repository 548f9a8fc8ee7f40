# pinocchio 4.1.0, base 10 km away: data.dtau_dq is imprecise (derivative of M a + h by q).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([6400.0, -4800.0, 6000.0])), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3(np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([0.0, 0.0, 0.0])), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 1.0])
v = np.array([1.0, 0.0])
a = np.array([0.0, 0.0])
pin.computeRNEADerivatives(m, d, q, v, a)
value = d.dtau_dq
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 1)], -0.4161468365471424
assert abs(value - expected) <= 4.7e-12, f"{value = }, {expected = }"
