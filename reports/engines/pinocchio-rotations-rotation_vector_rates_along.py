# pinocchio 4.1.0, rotations: Hlog3 is wrong (rate of A^-1 at the rotation vector of R, as R turns with v along the turned axes).
# not finite.
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
v = np.array([0.0, 0.0, 0.0])
R = pin.Quaternion(q)
value = pin.Hlog3(R.matrix(), v)
import numpy as np
value, expected = np.reshape(value, (3, 3))[(0, 0)], 0.0
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
