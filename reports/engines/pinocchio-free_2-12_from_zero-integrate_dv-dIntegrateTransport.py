# pinocchio 4.1.0, free, 2^-12 from zero: dIntegrateTransport is imprecise (derivative of integrate by v2).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, -0.0001239995655858489, 0.0, 0.0, 0.00015242901885576232])
value = pin.dIntegrateTransport(m, q, v2, np.eye(m.nv), pin.ARG1)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 3)], 6.300377358958554e-09
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
