# idyntree 15.1.0, fixed to the world first: getCentroidalTotalMomentumJacobian is wrong (A: momentum about the mass
# centre is A v).
import numpy as np, idyntree.bindings as iDynTree
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = False
loader.setParsingOptions(options)
assert loader.loadReducedModelFromString("""<robot name="tree"><link name="world"/><link name="a"><inertial>
<mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
<joint name="joint_a" type="fixed"><parent link="world"/><child link="a"/><origin xyz="1 0 0"/></joint>
<link name="b"><inertial><origin xyz="0 1 0"/><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link><joint name="joint_b" type="continuous">
<parent link="a"/><child link="b"/></joint></robot>""", ['joint_b'])
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase('world'), 'the reader has dropped the link world'
n = 6 + robot.getNrOfDegreesOfFreedom()
robot.setRobotState(np.eye(4), np.zeros(1), np.zeros(6), np.zeros(1), np.zeros(3))
J = iDynTree.MatrixDynSize(6, n)
assert robot.getCentroidalTotalMomentumJacobian(J)
value, expected = J.toNumPy()[:, 6:][4, 0], 0.0
assert abs(value - expected) <= 1.9e-12, f'value = {value!r}, expected = {expected!r}'
