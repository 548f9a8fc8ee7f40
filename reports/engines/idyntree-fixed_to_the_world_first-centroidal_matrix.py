"""idyntree 15.1.0: getCentroidalTotalMomentumJacobian, fixed to the world first.

Result: A (6, nv): momentum about the mass centre is A v.
Known: none found.
"""

import numpy as np
import idyntree.bindings as iDynTree
URDF = """<robot name="tree">
<link name="world"/>
<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="0.0"/>
<inertia ixx="0.0" ixy="0.0" ixz="0.0" iyy="0.0" iyz="0.0" izz="0.0"/></inertial></link>
<joint name="joint_a" type="fixed"><parent link="world"/><child link="a"/>
<origin xyz="1.0 0.0 0.0" rpy="0.0 0.0 0.0"/>
</joint>
<link name="b"><inertial><origin xyz="1.0 0.0 0.0"/><mass value="1.0"/>
<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="a"/><child link="b"/>
<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
loader = iDynTree.ModelLoader()
options = loader.parsingOptions()
options.addSensorFramesAsAdditionalFrames = False
loader.setParsingOptions(options)
assert loader.loadReducedModelFromString(URDF, ['joint_b'])
robot = iDynTree.KinDynComputations()
assert robot.loadRobotModel(loader.model())
robot.setFrameVelocityRepresentation(iDynTree.MIXED_REPRESENTATION)
assert robot.setFloatingBase("world"), "the reader has dropped the link world"
links, g = ['a', 'b'], np.array([0.0, 0.0, 0.0])

cut, n = 6, 6 + robot.getNrOfDegreesOfFreedom()
def state(q, v): robot.setRobotState(np.eye(4), q, np.zeros(6), v, g)
q = np.array([0.0])
v = np.array([0.0])
state(q, v)
J = iDynTree.MatrixDynSize(6, n)
assert robot.getCentroidalTotalMomentumJacobian(J)
value = J.toNumPy()[:, cut:]
value = np.array(value, dtype=float)
expected = np.array([[0.0], [0.6666666666666666], [0.3333333333333333], [0.6666666666666666], [-0.3333333333333333], [0.6666666666666666]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.6e-12
