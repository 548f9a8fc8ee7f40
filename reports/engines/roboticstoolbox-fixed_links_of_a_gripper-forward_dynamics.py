# roboticstoolbox 1.5.0, fixed links of a gripper: accel is wrong (M^-1 (tau - h)).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
from spatialmath import SE3
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'b': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0, 1]), 'c': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0, 1])}
l0_0 = Link(ETS([ET.Rz(jindex=0)]), name='a', parent=None, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
l1_0 = Link(ETS([ET.Ry(jindex=1)]), name='b', parent=l0_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
l2_0 = Link(ETS([ET.SE3(np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]))]), name='c', parent=l1_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
robot = Robot([l0_0, l1_0, l2_0], gravity=[0.0, 0.0, -9.81], gripper_links=[l2_0])
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([0.0, 0.0])
tau = np.array([0.3881357647151733, -0.10262307947376259])
value = robot.accel(q, v, tau)
import numpy as np
value, expected = np.reshape(value, (2,))[(0,)], 0.1293785882383911
assert abs(value - expected) <= 4.5e-13, f"{value = }, {expected = }"
