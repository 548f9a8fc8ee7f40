# idyntree 15.1.0, chain 2: oblique gravity, free base, 0: prismatic oblique, 0: prismatic oblique beyond, 0: mass at the origin, 0: at the origin: getCoriolisAndMassMatrices is wrong (C + C^T = dM/dt).
import numpy as np
import idyntree.bindings as iDynTree
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = False
loader.setParsingOptions(options)
if not loader.loadReducedModelFromString('<robot name="tree">\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n</robot>', []): raise ValueError('no model: see the log')
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase("a"), "the reader has dropped the link a"
links = ['a']
n = 6 + robot.getNrOfDegreesOfFreedom()
def state(q, v, robot):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, 3], pose[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    robot.setRobotState(pose, q[7:], v[:6], v[6:], np.array([0.0, 0.0, 0.0]))
gravity = np.array([0.0, 0.0, 0.0])
joints = []
ks = [robot.model().getLinkIndex(name) for name in links]
ends = []
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
state(q, v, robot)
C, M, M_rate = (iDynTree.MatrixDynSize(n, n) for _ in range(3))
assert robot.getCoriolisAndMassMatrices(C, M, M_rate)
value = M_rate.toNumPy()
import numpy as np
value, expected = np.reshape(value, (6, 6))[(0, 4)], 0.0
assert abs(value - expected) <= 1.0e-12, f"{value = }, {expected = }"
