# roboticstoolbox 1.5.0, hinge on a turned base: accel of a trajectory raises (M^-1 (tau - h)).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import ET, ETS, Link
Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot
from spatialmath import SE3
links = {'a': ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0])}
l0_0 = Link(ETS([ET.Rz(jindex=0)]), name='a', parent=None, m=1.3443265968445846, r=[-0.08014892836707332, -0.12975939971050243, 0.13470073605091082], I=np.array([[0.1210791738441683, 0.007163103951643457, -0.003148263120723315], [0.007163103951643457, 0.1379503790695927, -0.017943596506285665], [-0.003148263120723315, -0.017943596506285665, 0.15154757723496845]]))
robot = Robot([l0_0], gravity=[0.0, 0.0, -9.81], base=SE3(np.array([[-0.80804494315307, -0.38950608463480285, -0.44198232982464103, -0.2910860570339474], [0.4478511983296598, 0.08128179807531648, -0.8904058476090165, -0.015150265429595633], [0.38274361392378536, -0.9174302585668893, 0.10876142085524192, -0.1690924169065552], [0.0, 0.0, 0.0, 1.0]]), check=False))
q = np.array([-1.0996201868492035])
v = np.array([-0.7565606148471162])
a = np.array([0.04521670343786499])
tau = np.array([-0.1816631824515902])
Q, V, A, F = (np.stack([x / 2, x, 2 * x]) for x in (q, v, a, tau))
value = robot.accel(Q, V, F)[1]
