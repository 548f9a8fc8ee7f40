# pinocchio 4.1.0, chain 57: oblique gravity, 0: revolute unbounded, 0: mimic oblique beyond, 0: at the origin, 0: mass at the origin, 0: armature: appendModel to nothing, crba is wrong (M).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRUBY(), pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
m.armature = np.array([1.0])
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([1.0, 0.0])
if globals().get('made_by') != 'appendModel to nothing':
    made_by = 'appendModel to nothing'
    n = pin.Model()
    n.gravity = m.gravity
    m = pin.appendModel(n, m, 0, pin.SE3.Identity())
    d = m.createData()
value = pin.crba(m, d, q)
import numpy as np
value, expected = np.reshape(value, (1, 1))[(0, 0)], 2.0
assert abs(value - expected) <= 2.2e-12, f"{value = }, {expected = }"
