# roboticstoolbox 1.5.0, joints against x, y and z: accel of a trajectory is wrong (M^-1 (tau - h)).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'b': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0, 1])}
l0_0 = Link(ETS([ET.Rz(jindex=0, flip=True)]), name='a', parent=None, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
l1_0 = Link(ETS([ET.tx(jindex=1, flip=True)]), name='b', parent=l0_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
robot = Robot([l0_0, l1_0], gravity=[0.0, 0.0, 0.0])
q = np.array([0.0, 1.0])
v = np.array([1.0, 0.0])
a = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
Q, V, A, F = (np.stack([x / 2, x, 2 * x]) for x in (q, v, a, tau))
value = robot.accel(Q, V, F)[1]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 1.0
assert abs(value - expected) <= 1.3e-12, f"{value = }, {expected = }"
