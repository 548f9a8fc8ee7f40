# pybullet 3.2.7, urdf: children before parents: getJointInfo crashes (least and greatest coordinates).
# Known: https://github.com/bulletphysics/bullet3/issues/3267 (wrong trees by the same flag).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="r"><joint name="joint_b" type="revolute"><parent link="a" /><child link="b" /><origin xyz="0 0 0.5" /><axis xyz="0 1 0" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint><joint name="joint_a" type="revolute"><parent link="world" /><child link="a" /><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5" /><axis xyz="0 0 1" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint><link name="b"><inertial><origin xyz="0 0.1 0.2" /><mass value="1" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><link name="a"><inertial><origin xyz="0.1 -0.2 0.3" /><mass value="2" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><link name="world" /></robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(0.0, 0.0, -9.81)
joints = ()
moving = [0, 1]
links = [0, 1]
