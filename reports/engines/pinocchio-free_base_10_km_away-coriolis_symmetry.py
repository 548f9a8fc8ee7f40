# pinocchio 4.1.0, free base 10 km away: computeCoriolisMatrix is imprecise (C + C^T = dM/dt).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRX(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 0.0, 0.0])), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([0.0, 1.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([0.0, -4800.077706580394, 5999.243439385153, 0.273294341638708, 0.3567708494566067, -0.42174035036639745, -0.7875022797929568, -2.2370721443875343])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.4048856731701911])
C = pin.computeCoriolisMatrix(m, d, q, v)
value = C + C.T
import numpy as np
value, expected = np.reshape(value, (7, 7))[(5, 5)], -0.3934491589378902
assert abs(value - expected) <= 1.4e-09, f"{value = }, {expected = }"
