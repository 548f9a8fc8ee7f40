# roboticstoolbox 1.5.0, hinge by Denavit-Hartenberg parameters: accel raises (M^-1 (tau - h)).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import PrismaticDH, PrismaticMDH, RevoluteDH, RevoluteMDH
from spatialmath import SE3
links = ['a']
robot = rtb.DHRobot([RevoluteDH(d=(0.25), offset=0.375, a=0.5, alpha=1.25, m=1.0491771650349961, r=[-0.020983238094911677, 0.14968470333987932, 0.15859001020389368], I=np.array([[0.05698657964741411, -0.009066762477230629, -0.001806781028062233], [-0.009066762477230629, 0.05142827012051332, 0.0011198063172318867], [-0.001806781028062233, 0.0011198063172318867, 0.0637523199047484]]))], gravity=[0.0, 0.0, -9.81])
q = np.array([-1.0996201868492035])
v = np.array([-0.7565606148471162])
tau = np.array([-0.1816631824515902])
value = robot.accel(q, v, tau)
