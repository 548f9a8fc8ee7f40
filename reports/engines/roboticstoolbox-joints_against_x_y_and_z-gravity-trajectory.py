# roboticstoolbox 1.5.0, joints against x, y and z: gravload of a trajectory is wrong (g: gravity forces).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0])}
l0_0 = Link(ETS([ET.SE3(np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])), ET.Rz(jindex=0, flip=True)]), name='a', parent=None, m=1.0, r=[1.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
robot = Robot([l0_0], gravity=[0.0, 0.0, -9.81])
q = np.array([0.0])
v = np.array([0.0])
a = np.array([0.0])
tau = np.array([0.0])
Q, V, A, F = (np.stack([x / 2, x, 2 * x]) for x in (q, v, a, tau))
value = robot.gravload(Q)[1]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], -9.81
assert abs(value - expected) <= 1.4e-11, f"{value = }, {expected = }"
