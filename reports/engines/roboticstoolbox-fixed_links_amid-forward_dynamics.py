# roboticstoolbox 1.5.0, fixed links amid: accel is wrong (M^-1 (tau - h)).
import numpy as np
from roboticstoolbox import ET, ETS, Link, Robot
l0_0 = Link(ETS([ET.Rz(jindex=0)]), name='a', parent=None, m=1.0, r=np.zeros(3), I=np.diag([2.0, 3.0, 4.0]))
l1_0 = Link(ETS([ET.SE3(np.array([np.eye(4)[2], np.eye(4)[0], np.eye(4)[1], np.eye(4)[3]]))]), name='b', parent=l0_0,
    m=1.0, r=np.zeros(3), I=np.eye(3))
l2_0 = Link(ETS([ET.Rz(jindex=1)]), name='d', parent=l1_0, m=1.0, r=np.zeros(3), I=np.eye(3))
robot = Robot([l0_0, l1_0, l2_0], gravity=np.zeros(3))
value, expected = robot.accel(np.zeros(2), np.zeros(2), np.eye(2)[1])[0], 0.0
assert abs(value - expected) <= 2.2e-12, f'value = {value!r}, expected = {expected!r}'
