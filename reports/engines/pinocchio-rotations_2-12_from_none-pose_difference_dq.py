# pinocchio 4.1.0, rotations, 2^-12 from none: liegroups.SE3.dDifference is imprecise (derivative of the twist from X to Y by twists of X).
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
a = np.array([0.0, 0.0, 1.0])
tau = np.array([0.0, 0.0, 0.0])
q2 = np.array([7.051654060630695e-05, -8.335790490514098e-05, -0.00015565155218022814, 0.9999999819257356])
G, x, y = pin.liegroups.SE3(), np.r_[a, q], np.r_[tau, q2]
value = G.dDifference(x, y, pin.ARG0)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 3)], 5.188581055659185e-05
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
