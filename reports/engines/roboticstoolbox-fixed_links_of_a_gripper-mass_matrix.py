# roboticstoolbox 1.5.0, fixed links of a gripper: inertia is wrong (M).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
from spatialmath import SE3
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'c': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0])}
l0_0 = Link(ETS([ET.Rz(jindex=0)]), name='a', parent=None, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
l1_0 = Link(ETS([ET.SE3(np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]))]), name='c', parent=l0_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
robot = Robot([l0_0, l1_0], gravity=[0.0, 0.0, -9.81], gripper_links=[l1_0])
q = np.array([-1.0996201868492035])
value = robot.inertia(q)
import numpy as np
value, expected = np.reshape(value, (1, 1))[(0, 0)], 2.0
assert abs(value - expected) <= 3.0e-12, f"{value = }, {expected = }"
