# sapien 3.0.3, chain 1: 0: revolute oblique, 0: revolute oblique beyond: set_joint_properties, Scene.step is wrong (q+, v+ (nq + nv) after a step: v+ = v + h M^-1 f, f = tau + Q - (bias); q+ where v+ leads in h).
# Known: https://github.com/NVIDIA-Omniverse/PhysX/issues/498 (the 0.05 of PhysX; of the builder of SAPIEN none was found on 2026-11-28).
import warnings
import numpy as np
with warnings.catch_warnings():
    warnings.simplefilter('ignore')
    import sapien
    from sapien import physx
physx.set_scene_config(gravity=[0.0, 0.0, -9.81], enable_tgs=False)
scene = sapien.Scene([physx.PhysxCpuSystem()])
def pose(p, q): return sapien.Pose(p, q)
builder = scene.create_articulation_builder()
base = builder.create_link_builder()
l0 = builder.create_link_builder(base)
l0.set_name('a'); l0.set_joint_name('a')
l0.set_mass_and_inertia(1.0, pose([0.0, 0.0, 0.0], [0.08736937067466367, -0.5581657108495834, -0.8011548107778542, -0.19740466424883052]), [0.08213348181936879, 0.13541421821790384, 0.13713925320122103])
l0.set_joint_properties('revolute_unwrapped', [[-np.inf, np.inf]], pose([0.0, 0.0, 0.0], [6.123233995736766e-17, -0.7071067811865475, 0.0, -0.7071067811865475]), pose([0.0, 0.0, 0.0], [6.123233995736766e-17, -0.7071067811865475, 0.0, -0.7071067811865475]))
robot = builder.build(fix_root_link=True)
found = {joint.name: k for k, joint in enumerate(robot.active_joints)}
own = [found[name] for name in ['a']]
place = np.argsort(own)
links = [robot.find_link_by_name(name) for name in ['a']]
robot.set_sleep_threshold(0.0)
for link in robot.links:
    link.set_linear_damping(0.0); link.set_angular_damping(0.0)
    link.set_max_linear_velocity(1e9); link.set_max_angular_velocity(1e9)
for joint in robot.active_joints: joint.set_max_velocity(1e9)
def put(q, v):
    robot.set_qpos(q[place].astype(np.float32)); robot.set_qvel(v[place].astype(np.float32))
def parts(x): return np.array(x)[own]
model = robot.create_pinocchio_model(gravity=[0.0, 0.0, -9.81])
q = np.array([0.0])
v = np.array([1.0])
tau = np.array([0.0])
scene.set_timestep(0.015625)
put(q, v)
robot.set_qf((tau)[place].astype(np.float32))
scene.step()
value = [*parts(robot.get_qpos()), *parts(robot.get_qvel())]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 1.0
assert abs(value - expected) <= 7.8e-04, f"{value = }, {expected = }"
