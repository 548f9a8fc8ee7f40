# roboticstoolbox 1.5.0, hinge by modified Denavit-Hartenberg parameters: rne_python, base_wrench is wrong (what the world exerts on the first links, about its origin along its axes).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import PrismaticDH, PrismaticMDH, RevoluteDH, RevoluteMDH
from spatialmath import SE3
links = ['a']
robot = rtb.DHRobot([RevoluteMDH(d=(0.0), offset=0.375, a=(1.0), alpha=1.25, m=1.0, r=[0.0, 0.0, 0.0], I=np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))], gravity=[0.0, 0.0, -9.81])
q = np.array([-1.0996201868492035])
v = np.array([0.0])
a = np.array([0.0])
_, own = robot.rne_python(q, v, a, base_wrench=True)
value = robot.base.inv().Ad().T @ own
import numpy as np
value, expected = np.reshape(value, (6,))[(4,)], -9.81
assert abs(value - expected) <= 1.5e-11, f"{value = }, {expected = }"
