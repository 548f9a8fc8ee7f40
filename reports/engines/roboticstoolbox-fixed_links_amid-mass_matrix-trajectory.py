# roboticstoolbox 1.5.0, fixed links amid: inertia of a trajectory is wrong (M).
# Known: https://github.com/petercorke/robotics-toolbox-python/issues/483.
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
links = {'a': ([[-0.7071067811865475, -0.2357022603955158, 0.6666666666666666], [0.0, -0.9428090415820632, -0.3333333333333333], [0.7071067811865475, -0.2357022603955158, 0.6666666666666666]], [0]), 'b': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'd': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0, 1])}
l0_0 = Link(ETS([ET.SE3(np.array([[-0.7071067811865475, -0.2357022603955158, 0.6666666666666666, 0.0], [0.0, -0.9428090415820632, -0.3333333333333333, 0.0], [0.7071067811865475, -0.2357022603955158, 0.6666666666666666, 0.0], [0.0, 0.0, 0.0, 1.0]])), ET.Rz(jindex=0)]), name='a', parent=None, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[0.9999999999999998, -9.149958124033984e-19, -7.66449056764364e-18], [-9.149958124033984e-19, 0.9999999999999998, 1.7974594420119498e-17], [-7.66449056764364e-18, 1.7974594420119498e-17, 0.9999999999999999]]))
l1_0 = Link(ETS([ET.SE3(np.array([[-0.7071067811865475, 0.0, 0.7071067811865475, 0.0], [-0.2357022603955158, -0.9428090415820632, -0.2357022603955158, 0.0], [0.6666666666666666, -0.3333333333333333, 0.6666666666666666, 0.0], [0.0, 0.0, 0.0, 1.0]]))]), name='b', parent=l0_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
l2_0 = Link(ETS([ET.Rx(jindex=1)]), name='d', parent=l1_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
robot = Robot([l0_0, l1_0, l2_0], gravity=[0.0, 0.0, 0.0])
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
a = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
Q, V, A, F = (np.stack([x / 2, x, 2 * x]) for x in (q, v, a, tau))
value = robot.inertia(Q)[1]
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 1)], 0.6666666666666666
assert abs(value - expected) <= 3.9e-12, f"{value = }, {expected = }"
