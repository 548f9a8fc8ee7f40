# idyntree 15.1.0, free, 2^-27 from zero: generalizedGravityForces, world is imprecise (g: gravity forces).
# at zero, after mass_matrix at another state on the same model: right by itself.
import numpy as np
import idyntree.bindings as iDynTree
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = False
loader.setParsingOptions(options)
if not loader.loadReducedModelFromString('<robot name="tree">\n<link name="a"><inertial><origin xyz="0.07948122665296731 -0.05566209643690764 0.14027915272082936"/><mass value="1.00651724851665"/>\n<inertia ixx="0.14390333371975564" ixy="-0.00051273024743222" ixz="0.00047384203999974086" iyy="0.1456183223889136" iyz="-0.00018777010027124473" izz="0.14392176348665386"/></inertial></link>\n<link name="b"><inertial><origin xyz="0.0755981066421495 -0.14360289043669694 0.17582702621540475"/><mass value="0.5524981606714428"/>\n<inertia ixx="0.10358549907908647" ixy="-0.002110580404381903" ixz="-0.006296218168244841" iyy="0.14107976980736472" iyz="-0.008753906149537811" izz="0.1019826960088734"/></inertial></link>\n<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>\n<origin xyz="0.28678414398198837 -0.1709856453013494 0.21486417621116072" rpy="0.4629806214436481 0.48504247022118757 1.6772482998074136"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n</joint>\n</robot>', ['joint_b']): raise ValueError('no model: see the log')
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase("a"), "the reader has dropped the link a"
links = ['a', 'b']
n = 6 + robot.getNrOfDegreesOfFreedom()
def state(q, v, robot):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, 3], pose[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    robot.setRobotState(pose, q[7:], v[:6], v[6:], np.array([0.0, 0.0, -9.81]))
gravity = np.array([0.0, 0.0, -9.81])
joints = ['joint_b']
ks = [robot.model().getLinkIndex(name) for name in links]
ends = []
q = np.array([-3.2771235312497716e-09, -5.789591401377001e-10, -5.636815837376686e-09, 2.0362015461804192e-09, 2.658150003910481e-09, -3.142210513227477e-09, 1.0, -1.6667486312892544e-08])
v = np.array([4.668613311494632e-09, -7.3764977982727005e-09, -2.5323727116361636e-09, -6.123082986310683e-09, -4.776282937907621e-10, 1.7537096124894863e-09, 7.606754146926931e-10])
state(q, v, robot)
M = iDynTree.MatrixDynSize()
assert robot.getFreeFloatingMassMatrix(M)
value = M.toNumPy()
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
state(q, v, robot)
robot.setFrameVelocityRepresentation(iDynTree.INERTIAL_FIXED_REPRESENTATION)
H = robot.getWorldBaseTransform().asHomogeneousTransform().toNumPy()
T = np.eye(n)
T[:3, 3:6] = np.cross(np.eye(3), H[:3, 3])
value = np.zeros(n)
assert robot.generalizedGravityForces(value)
value = (T.T @ value)
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
import numpy as np
value, expected = np.reshape(value, (7,))[(0,)], 0.0
assert abs(value - expected) <= 2.5e-11, f"{value = }, {expected = }"
