# pybullet 3.2.7, sdf: pose relative to a link, empty: getLinkState crashes (positions and rows of R).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".sdf")
print('<sdf version="1.9"><model name="m"><link name="a"><pose>0.1 0.2 0.3 0.3 -0.4 0.5</pose><inertial><pose>0.1 -0.2 0.3 0 0 0</pose><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link><link name="b"><pose relative_to="a" /><inertial><pose>0 0.1 0.2 0 0 0</pose><mass>1</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link><joint name="ja" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 0 1</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit></axis></joint><joint name="jb" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit></axis></joint></model></sdf>', file=file, flush=True)
robot = p.loadSDF(file.name)[0]
gravity = True
p.setGravity(0.0, 0.0, -9.81)
joints = [p.getJointInfo(robot, k) for k in range(p.getNumJoints(robot))]
moving = [joint[0] for joint in joints if joint[2] != p.JOINT_FIXED]
links = [] + [joint[0] for name in ['a', 'b'] for joint in joints if joint[12].decode() == name]
