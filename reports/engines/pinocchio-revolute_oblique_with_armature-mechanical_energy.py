# pinocchio 4.1.0, revolute oblique with armature: computeMechanicalEnergy is wrong (T + V).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3(np.array([[-0.8668563065832781, -0.18320610964130357, 0.46367625033734094], [-0.019006443612300878, -0.9172146705593321, -0.39793969795931167], [0.49819564313431147, -0.35376937332227393, 0.7916112250727344]]), np.array([-0.3614426664762368, 0.06408004371351683, 0.30323671397900875])), 'b')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
m.armature = np.array([0.75])
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([-1.8914015371177906])
v = np.array([0.9725767279334938])
value = pin.computeMechanicalEnergy(m, d, q, v)
import numpy as np
value, expected = np.reshape(value, ())[()], 0.8276673052530936
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
