# pinocchio 4.1.0, chain 1: 0: revolute oblique, 0: revolute oblique beyond: computeCentroidalMapTimeVariation is wrong (dA/dt).
# Known: https://github.com/stack-of-tasks/pinocchio/issues/2093 (of both functions; what mended it mended dccrba alone).
import numpy as np
import pinocchio as pin
m = pin.Model()
m.gravity.linear = np.array([0.0, 0.0, 0.0])
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([1.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3.Identity(), 'b0')
m.appendBodyToJoint(j1, pin.Inertia(1.0, np.array([1.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 1.0])
v = np.array([0.0, 1.0])
value = pin.computeCentroidalMapTimeVariation(m, d, q, v)
import numpy as np
value, expected = np.reshape(value, (6, 2))[(5, 0)], 0.8414709848078965
assert abs(value - expected) <= 2.7e-12, f"{value = }, {expected = }"
