"""pybullet 3.2.7: calculateJacobian, sdf: pose relative to its joint.

Result: Jacobians of the links (L, 6, nv).
Known: none found.
"""

import tempfile
import pybullet as p
TEXT = """<sdf version="1.9"><model name="m"><link name="a"><pose relative_to="ja"/><inertial><pose>0.1 -0.2 0.3 0 0 0</pose><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link><joint name="ja" type="revolute"><pose relative_to="__model__">0.1 0.2 0.3 0.3 -0.4 0.5</pose><parent>world</parent><child>a</child><axis><xyz>0.6 0 0.8</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit></axis></joint></model></sdf>"""
if not p.isConnected():
    p.connect(p.DIRECT)
p.setGravity(*[0.0, 0.0, -9.81])
with tempfile.NamedTemporaryFile("w", suffix=".sdf") as file:
    file.write(TEXT)
    file.flush()
    flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER
    robot = p.loadSDF(file.name)[0]
named = {p.getJointInfo(robot, k)[12].decode(): k for k in range(p.getNumJoints(robot))}
links = [named[name] for name in ['a']]
moving = [k for k in range(p.getNumJoints(robot)) if p.getJointInfo(robot, k)[2] != p.JOINT_FIXED]

