# pinocchio 4.1.0, rotations, 2^-8 from none: Jexp6 is imprecise (J: the twist of exp x in its own frame is J x', at x = (v; v2)).
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
v = np.array([0.15161553309186457, -0.04008714041943851, 0.10951313171075157])
v2 = np.array([0.0, 0.0, -0.0032102589327268555])
V = pin.Motion(v, v2)
value = pin.Jexp6(V)
import numpy as np
value, expected = np.reshape(value, (6, 6))[(2, 3)], -0.020124673807476574
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
