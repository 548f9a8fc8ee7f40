# pinocchio 4.1.0, rotations, 2^-12 from each other: liegroups.SE3.dDifference is wrong (derivative of the twist from X to Y by twists of X).
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
q = np.array([-0.18877504894423414, 0.6317591176355501, 0.7331581168476692, 0.16650397557065305])
a = np.array([0.0, 0.0, -1.0])
tau = np.array([0.0, 1.0, 1.0])
q2 = np.array([-0.18880052401058886, 0.6317675434391433, 0.7331033734192399, 0.16668406363995217])
G, x, y = pin.liegroups.SE3(), np.r_[a, q], np.r_[tau, q2]
value = G.dDifference(x, y, pin.ARG0)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(1, 4)], -8.763771740303485e-05
assert abs(value - expected) <= 1.6e-12, f"{value = }, {expected = }"
