# sapien 3.0.3, chain 23: 0: revolute oblique beyond, 0: armature beyond, 0: revolute oblique: PinocchioModel.compute_forward_dynamics is wrong (M^-1 (tau - h)).
import warnings
import numpy as np
with warnings.catch_warnings():
    warnings.simplefilter('ignore')
    import sapien
    from sapien import physx
physx.set_scene_config(gravity=[0.0, 0.0, 0.0], enable_tgs=False)
scene = sapien.Scene([physx.PhysxCpuSystem()])
def pose(p, q): return sapien.Pose(p, q)
builder = scene.create_articulation_builder()
base = builder.create_link_builder()
l0 = builder.create_link_builder(base)
l0.set_name('c0'); l0.set_joint_name('c0')
l0.set_mass_and_inertia(1.0, pose([0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]), [1.0, 1.0, 1.0])
l0.set_joint_properties('revolute_unwrapped', [[-np.inf, np.inf]], pose([0.0, 0.0, 0.0], [6.123233995736766e-17, -0.7071067811865475, 0.0, -0.7071067811865475]), pose([0.0, 0.0, 0.0], [6.123233995736766e-17, -0.7071067811865475, 0.0, -0.7071067811865475]))
robot = builder.build(fix_root_link=True)
robot.find_joint_by_name('c0').set_armature([1.0])
found = {joint.name: k for k, joint in enumerate(robot.active_joints)}
own = [found[name] for name in ['c0']]
place = np.argsort(own)
links = [robot.find_link_by_name(name) for name in ['c0']]
robot.set_sleep_threshold(0.0)
for link in robot.links:
    link.set_linear_damping(0.0); link.set_angular_damping(0.0)
    link.set_max_linear_velocity(1e9); link.set_max_angular_velocity(1e9)
for joint in robot.active_joints: joint.set_max_velocity(1e9); joint.set_friction(0.0)
def put(q, v):
    robot.set_qpos(q[place].astype(np.float32)); robot.set_qvel(v[place].astype(np.float32))
def parts(x): return np.array(x)[own]
model = robot.create_pinocchio_model(gravity=[0.0, 0.0, 0.0])
q = np.array([0.0])
v = np.array([0.0])
tau = np.array([1.0])
value = parts(model.compute_forward_dynamics(q[place], v[place], tau[place]))
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 0.5
assert abs(value - expected) <= 4.0e-04, f"{value = }, {expected = }"
