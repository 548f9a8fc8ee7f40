# idyntree 15.1.0, free base beside its body: createReducedModel, generalizedBiasForces is wrong (h: Coriolis, centrifugal and gravity forces).
import numpy as np
import idyntree.bindings as iDynTree
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = False
loader.setParsingOptions(options)
if not loader.loadReducedModelFromString('<robot name="tree">\n<link name="base"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="0.0"/>\n<inertia ixx="0.0" ixy="0.0" ixz="0.0" iyy="0.0" iyz="0.0" izz="0.0"/></inertial></link>\n<link name="b"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n<joint name="joint_b" type="fixed"><parent link="base"/><child link="b"/>\n<origin xyz="1.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n</joint>\n</robot>', []): raise ValueError('no model: see the log')
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase("base"), "the reader has dropped the link base"
links = ['base', 'b']
n = 6 + robot.getNrOfDegreesOfFreedom()
def state(q, v, robot):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, 3], pose[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    robot.setRobotState(pose, q[7:], v[:6], v[6:], np.array([0.0, 0.0, 0.0]))
gravity = np.array([0.0, 0.0, 0.0])
joints = []
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
if globals().get('made_by') != 'createReducedModel':
    made_by = 'createReducedModel'
    model = iDynTree.Model()
    assert iDynTree.createReducedModel(robot.model(), joints, model)
    kept, robot = robot, iDynTree.KinDynComputations()
    assert robot.loadRobotModel(model)
    robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
    assert robot.setFloatingBase(kept.getFloatingBase())
state(q, v, robot)
value = np.zeros(n)
assert robot.generalizedBiasForces(value)
value = value
import numpy as np
value, expected = np.reshape(value, (6,))[(0,)], -1.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
