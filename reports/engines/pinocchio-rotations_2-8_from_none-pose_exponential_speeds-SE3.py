# pinocchio 4.1.0, rotations, 2^-8 from none: liegroups.SE3.dIntegrate_dv is imprecise (J: the twist of exp x in its own frame is J x', at x = (v; v2)).
# Known: https://github.com/stack-of-tasks/pinocchio/pull/584 (bounds of the series by the scalar's precision).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelSpherical(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 1.0])
a = np.array([0.0, 0.0, 0.0])
tau = np.array([0.0, 0.0, 0.0])
v2 = np.array([0.0, 0.0, -0.0032102589327268555])
q2 = np.array([0.0, 0.0, 0.0, 1.0])
G, x, y = pin.liegroups.SE3(), np.r_[a, q], np.r_[tau, q2]
value = G.dIntegrate_dv(x, np.r_[v, v2])
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 3)], 0.0010700852081038294
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
