# sapien 3.0.3, urdf: losses left out: compute_passive_force raises (h: Coriolis, centrifugal and gravity forces).
import warnings
import numpy as np
with warnings.catch_warnings():
    warnings.simplefilter('ignore')
    import sapien
    from sapien import physx
physx.set_scene_config(gravity=[0.0, 0.0, -9.81], enable_tgs=False)
scene = sapien.Scene([physx.PhysxCpuSystem()])
def pose(p, q): return sapien.Pose(p, q)
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="r"><link name="world" /><link name="a"><inertial><origin xyz="0.1 -0.2 0.3" /><mass value="2" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2" /><mass value="1" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><joint name="joint_a" type="revolute"><parent link="world" /><child link="a" /><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5" /><axis xyz="0 0 1" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint><joint name="joint_b" type="revolute"><parent link="a" /><child link="b" /><origin xyz="0 0 0.5" /><axis xyz="0 1 0" /><limit lower="-9" upper="9" effort="9" velocity="9" /><dynamics /></joint></robot>', file=file, flush=True)
robot = scene.create_urdf_loader().load(file.name)
found = {joint.name: k for k, joint in enumerate(robot.active_joints)}
own = [found[name] for name in ['joint_a', 'joint_b']]
place = np.argsort(own)
links = [robot.find_link_by_name(name) for name in ['a', 'b']]
robot.set_sleep_threshold(0.0)
for link in robot.links:
    link.set_linear_damping(0.0); link.set_angular_damping(0.0)
    link.set_max_linear_velocity(1e9); link.set_max_angular_velocity(1e9)
for joint in robot.active_joints: joint.set_max_velocity(1e9); joint.set_friction(0.0)
def put(q, v):
    robot.set_qpos(q[place].astype(np.float32)); robot.set_qvel(v[place].astype(np.float32))
def parts(x): return np.array(x)[own]
model = robot.create_pinocchio_model(gravity=[0.0, 0.0, -9.81])
