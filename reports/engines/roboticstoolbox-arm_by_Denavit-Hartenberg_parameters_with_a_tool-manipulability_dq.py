# roboticstoolbox 1.5.0, arm by Denavit-Hartenberg parameters, with a tool: jacobm is imprecise (its derivatives).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import PrismaticDH, PrismaticMDH, RevoluteDH, RevoluteMDH
from spatialmath import SE3
links = ['a', 'b', 'c', 'd', 'e', 'f']
robot = rtb.DHRobot([RevoluteDH(d=(0.25), offset=0.375, a=0.125, alpha=1.25, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), RevoluteDH(d=(-0.125), offset=-0.25, a=0.5, alpha=0.25, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), RevoluteDH(d=(0.0625), offset=0.5, a=0.375, alpha=-1.0, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), RevoluteDH(d=(0.5), offset=0.0, a=0.0, alpha=1.5, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), RevoluteDH(d=(0.0), offset=0.25, a=0.125, alpha=-1.25, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])), RevoluteDH(d=(0.25), offset=-0.5, a=0.0625, alpha=0.75, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))], gravity=[0.0, 0.0, -9.81], tool=SE3(np.array([[-0.30190493895481274, -0.16603657632968308, 0.93876794957828, -0.19784157266705604], [-0.742471257911643, -0.5767201424692272, -0.34077897300945187, 0.09027802159598586], [0.5979881595899648, -0.7998910754540218, 0.05083727371934061, 0.48383048405393303], [0.0, 0.0, 0.0, 1.0]]), check=False))
q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547, -2.005166620907341, 0.9703394117879331, 0.7008840429488101])
value = np.ravel(robot.jacobm(q))
import numpy as np
value, expected = np.reshape(value, (6,))[(1,)], -0.218385444860542
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
