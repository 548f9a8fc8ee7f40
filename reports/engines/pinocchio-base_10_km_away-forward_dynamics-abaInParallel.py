# pinocchio 4.1.0, base 10 km away: abaInParallel is imprecise (M^-1 (tau - h)).
import numpy as np
import pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([6400.0, -4800.0, 6000.0])), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.0, np.array([0.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
j1 = m.addJoint(j0, pin.JointModelRZ(), pin.SE3(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]), np.array([0.0, 0.0, 0.0])), 'b')
m.appendBodyToJoint(j1, pin.Inertia(0.7734754996812343, np.array([1.0, 0.0, 0.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1]
d = m.createData()
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
q2 = np.array([0.0, 0.0])
pool = pin.ModelPool(m, 2)
q2 = pin.neutral(m)
value = pin.abaInParallel(2, pool, np.column_stack([q2, q]), np.column_stack([tau, v]), np.column_stack([v, tau]))[:, 1]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -4.2784885684841685
assert abs(value - expected) <= 1.4e-09, f"{value = }, {expected = }"
