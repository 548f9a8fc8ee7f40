# roboticstoolbox 1.5.0, fixed links of a gripper: gravload is wrong (g: gravity forces).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
from spatialmath import SE3
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0]), 'c': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0])}
l0_0 = Link(ETS([ET.SE3(np.array([[-0.08198917647165427, -0.9744534686532653, 0.20908900585903495, 0.4641656243805138], [0.9894190792209788, -0.10478122050085549, -0.1003532834732452, 0.4113511925484873], [0.1196982063984684, 0.19864876858407834, 0.9727337796771627, 0.17776579380333912], [0.0, 0.0, 0.0, 1.0]])), ET.Rz(jindex=0)]), name='a', parent=None, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
l1_0 = Link(ETS([ET.SE3(np.array([[-0.1885228664640877, 0.953124561705847, 0.23667002068956836, -0.23543521720890814], [-0.8868384306625765, -0.061700475709119164, -0.45794175306168233, -0.38453603698011884], [-0.42187287981108973, -0.2962205616939941, 0.8568994410720504, -0.27709778148378383], [0.0, 0.0, 0.0, 1.0]]))]), name='c', parent=l0_0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
robot = Robot([l0_0, l1_0], gravity=[0.0, 0.0, -9.81], gripper_links=[l1_0])
q = np.array([-1.0996201868492035])
value = robot.gravload(q)
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], -0.9173394810563378
assert abs(value - expected) <= 1.1e-11, f"{value = }, {expected = }"
