# pinocchio 4.1.0, chain 28: 0: slide and ball, 0: revolute oblique beyond: computeGeneralizedGravityDerivatives is wrong (derivative of g by q).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2053.
import numpy as np
import pinocchio as pin
m = pin.Model()
c = pin.JointModelComposite()
c.addJoint(pin.JointModelPX(), pin.SE3.Identity())
c.addJoint(pin.JointModelSpherical(), pin.SE3.Identity())
j0 = m.addJoint(0, c, pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0]
d = m.createData()
q = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
value = pin.computeGeneralizedGravityDerivatives(m, d, q)
import numpy as np
value, expected = np.reshape(value, (4, 4))[(0, 2)], 0.0
assert abs(value - expected) <= 1.1e-11, f"{value = }, {expected = }"
