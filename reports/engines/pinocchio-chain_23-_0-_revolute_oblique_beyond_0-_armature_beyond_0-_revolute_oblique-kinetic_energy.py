# pinocchio 4.1.0, chain 23: 0: revolute oblique beyond, 0: armature beyond, 0: revolute oblique: computeKineticEnergy is wrong (T = v^T M v / 2).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3.Identity(), 'c0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
m.armature = np.array([1.0])
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0])
v = np.array([1.0])
value = pin.computeKineticEnergy(m, d, q, v)
import numpy as np
value, expected = np.reshape(value, ())[()], 1.0
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
