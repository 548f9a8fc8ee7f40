# pinocchio 4.1.0, ball, 2^-12 from zero: lieGroup.dDifference is imprecise (derivative of difference by its first configuration).
# Known: https://github.com/stack-of-tasks/pinocchio/pull/584 (bounds of the series by the scalar's precision).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelSpherical(), pin.SE3.Identity(), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 1.0])
v2 = np.array([0.0, 0.0, -0.00017345543275712108])
G = pin.lieGroup(m)
q1 = G.integrate(q, v2)
value = G.dDifference(q, q1, pin.ARG0)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], -0.9999999974927677
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
