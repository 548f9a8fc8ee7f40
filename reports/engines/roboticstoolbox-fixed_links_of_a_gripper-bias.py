# roboticstoolbox 1.5.0, fixed links of a gripper: rne is wrong (h: Coriolis, centrifugal and gravity forces).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
from spatialmath import SE3
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'c': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0])}
l0_0 = Link(ETS([ET.SE3(np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])), ET.Rz(jindex=0)]), name='a', parent=None, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
l1_0 = Link(ETS([ET.SE3(np.array([[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]))]), name='c', parent=l0_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
robot = Robot([l0_0, l1_0], gravity=[0.0, 0.0, -9.81], gripper_links=[l1_0])
q = np.array([0.0])
v = np.array([0.0])
value = robot.rne(q, v, np.zeros(len(v)))
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 9.81
assert abs(value - expected) <= 2.2e-11, f"{value = }, {expected = }"
