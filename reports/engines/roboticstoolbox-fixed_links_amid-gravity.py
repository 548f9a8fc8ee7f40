# roboticstoolbox 1.5.0, fixed links amid: gravload is wrong (g: gravity forces).
import numpy as np
from roboticstoolbox import ET, ETS, Link, Robot
l0_0 = Link(ETS([ET.SE3(np.array([np.eye(4)[2], np.eye(4)[0], np.eye(4)[1], np.eye(4)[3]]))]), name='b', parent=None,
    m=1.0, r=np.zeros(3), I=np.eye(3))
l1_0 = Link(ETS([ET.Rz(jindex=0)]), name='d', parent=l0_0, m=1.0, r=np.eye(3)[0], I=np.eye(3))
robot = Robot([l0_0, l1_0], gravity=[0.0, 0.0, -9.81])
value, expected = robot.gravload(np.zeros(1))[0], 9.81
assert abs(value - expected) <= 2.2e-11, f'value = {value!r}, expected = {expected!r}'
