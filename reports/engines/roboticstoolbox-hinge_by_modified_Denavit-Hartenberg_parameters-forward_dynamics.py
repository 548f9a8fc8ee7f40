# roboticstoolbox 1.5.0, hinge by modified Denavit-Hartenberg parameters: accel raises (M^-1 (tau - h)).
import numpy as np
import roboticstoolbox as rtb
from roboticstoolbox import PrismaticDH, PrismaticMDH, RevoluteDH, RevoluteMDH
from spatialmath import SE3
links = ['a']
robot = rtb.DHRobot([RevoluteMDH(d=(0.25), offset=0.375, a=(0.5), alpha=1.25, m=1.2771429834074874, r=[-0.17459527835055955, 0.11777356554888496, 0.11060325114794772], I=np.array([[0.07844809406615627, -0.0051093858848532975, 0.004076556865521433], [-0.0051093858848532975, 0.1034808456479665, -0.01531689147157789], [0.004076556865521433, -0.01531689147157789, 0.08948068674916414]]))], gravity=[0.0, 0.0, -9.81])
q = np.array([-1.0996201868492035])
v = np.array([-0.7565606148471162])
tau = np.array([-0.1816631824515902])
value = robot.accel(q, v, tau)
