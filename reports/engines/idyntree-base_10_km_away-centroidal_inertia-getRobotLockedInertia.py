# idyntree 15.1.0, base 10 km away: getRobotLockedInertia is imprecise (momentum of all links, as one body, about the mass centre for twists there, along the world's axes).
import numpy as np
import idyntree.bindings as iDynTree
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = False
loader.setParsingOptions(options)
if not loader.loadReducedModelFromString('<robot name="tree">\n<link name="world"/>\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.8187017420963922"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>\n<origin xyz="6400.0 -4800.0 6000.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.0 0.0 1.0"/>\n</joint>\n</robot>', ['joint_a']): raise ValueError('no model: see the log')
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase("world"), "the reader has dropped the link world"
links = ['a']
n = 6 + robot.getNrOfDegreesOfFreedom()
def state(q, v, robot):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, 3], pose[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    robot.setRobotState(pose, q[7:], v[:6], v[6:], np.array([0.0, 0.0, 0.0]))
gravity = np.array([0.0, 0.0, 0.0])
joints = ['joint_a']
ks = [robot.model().getLinkIndex(name) for name in links]
ends = []
js = [robot.model().getLinkIndex(name) for name in ['a']]
q = np.array([0.0])
v = np.array([0.0])
robot.setRobotState(np.eye(4), q, np.zeros(6), v, np.array([0.0, 0.0, 0.0]))
ks
base = robot.getWorldBaseTransform().asHomogeneousTransform().toNumPy()[:3, 3]
arm = robot.getCenterOfMassPosition().toNumPy() - base
S = np.cross(np.eye(3), arm)
B = np.block([[np.eye(3), np.zeros((3, 3))], [-S, np.eye(3)]])
value = B @ robot.getRobotLockedInertia().asMatrix().toNumPy() @ B.T
import numpy as np
value, expected = np.reshape(value, (6, 6))[(4, 4)], 1.0
assert abs(value - expected) <= 2.7e-12, f"{value = }, {expected = }"
