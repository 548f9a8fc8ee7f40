# idyntree 15.1.0, chain 2: oblique gravity, free base, 0: prismatic oblique, 0: prismatic oblique beyond, 0: mass at the origin, 0: at the origin: generalizedGravityForces, world is wrong (g: gravity forces).
# at zero, after mass_matrix at another state on the same model: right by itself.
import numpy as np
import idyntree.bindings as iDynTree
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = False
loader.setParsingOptions(options)
if not loader.loadReducedModelFromString('<robot name="tree">\n<link name="a"><inertial><origin xyz="-0.04692389316111645 0.12487996838473953 0.1324796751434048"/><mass value="1.4550784646007584"/>\n<inertia ixx="0.12717012274604628" ixy="-0.0046520620266138155" ixz="-0.0017065387184695916" iyy="0.1331972476030545" iyz="-0.0006747812469444989" izz="0.12777704170068946"/></inertial></link>\n<link name="b0"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.2942215525356693"/>\n<inertia ixx="0.1383161406266576" ixy="0.0013767918372937682" ixz="0.007981946164863554" iyy="0.12343026343428908" iyz="-0.0010266075280808329" izz="0.14134057776520043"/></inertial></link>\n<joint name="joint_b0" type="prismatic"><parent link="a"/><child link="b0"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>\n</joint>\n<link name="c0"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="0.7714678352758403"/>\n<inertia ixx="0.13007453549163428" ixy="-0.009355559666097095" ixz="0.01665556870454687" iyy="0.10259852013425877" iyz="-0.022912523219443915" izz="0.12182310844903738"/></inertial></link>\n<joint name="joint_c0" type="prismatic"><parent link="b0"/><child link="c0"/>\n<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>\n<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>\n<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>\n</joint>\n</robot>', ['joint_b0', 'joint_c0']): raise ValueError('no model: see the log')
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase("a"), "the reader has dropped the link a"
links = ['a', 'b0', 'c0']
n = 6 + robot.getNrOfDegreesOfFreedom()
def state(q, v, robot):
    x, y, z, w = q[3:7]
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, 3], pose[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K
    robot.setRobotState(pose, q[7:], v[:6], v[6:], np.array([3.0, -6.0, 2.0]))
gravity = np.array([3.0, -6.0, 2.0])
joints = ['joint_b0', 'joint_c0']
ks = [robot.model().getLinkIndex(name) for name in links]
ends = []
q = np.array([-0.43984807473968135, -0.07770658039411571, -0.7565606148471162, 0.273294341638708, 0.3567708494566067, -0.42174035036639745, -0.7875022797929568, -0.8948288577550136, 0.6266106715793658])
v = np.array([-0.33988931180500503, -0.821826286778075, -0.0641061844211126, 0.23537891976009928, 0.10209612590551109, -0.731876255043522, 0.4048856731701911, 0.2259388119684964])
state(q, v, robot)
M = iDynTree.MatrixDynSize()
assert robot.getFreeFloatingMassMatrix(M)
value = M.toNumPy()
q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
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
value, expected = np.reshape(value, (8,))[(1,)], 21.12460711447361
assert abs(value - expected) <= 3.3e-11, f"{value = }, {expected = }"
