# pybullet 3.2.7, chain 2: oblique gravity, free base, 0: prismatic oblique, 0: prismatic oblique beyond, 0: mass at the origin, 0: at the origin: calculateInverseDynamics is wrong (g: gravity forces).
# Known: https://github.com/bulletphysics/bullet3/issues/2570 (the order of the angles in BulletInverseDynamics).
from tempfile import NamedTemporaryFile
import numpy as np
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile("w", suffix=".urdf")
print('<robot name="tree">\n<link name="a"><inertial><origin xyz="0.0 0.0 0.0"/><mass value="1.0"/>\n<inertia ixx="1.0" ixy="0.0" ixz="0.0" iyy="1.0" iyz="0.0" izz="1.0"/></inertial></link>\n</robot>', file=file, flush=True)
robot = p.loadURDF(file.name, useFixedBase=False, flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_MAINTAIN_LINK_ORDER)
gravity = True
p.setGravity(3.0, -6.0, 2.0)
joints = ()
moving = []
links = [-1]
joints
base, still = p.getDynamicsInfo(robot, -1), len(moving)
centre, own = np.array(base[3]), np.reshape(p.getMatrixFromQuaternion(base[4]), (3, 3))
about = np.eye(6 + still)
about[:6, :6] = np.block([[np.zeros((3, 3)), own.T], [own.T, own.T @ np.cross(np.eye(3), centre).T]])
def product(x, y): return [*(x[3] * y[:3] + y[3] * x[:3] + np.cross(x[:3], y[:3])), x[3] * y[3] - x[:3] @ y[:3]]
def inverse_dynamics(q, v, a):
    v, a = about @ v, about @ a
    a[3:6] += np.cross(v[:3], v[3:6])
    position = q[:3] + np.reshape(p.getMatrixFromQuaternion(q[3:7]), (3, 3)) @ centre
    place = [*position, *product(q[3:7], np.array(base[4]))]
    forces = np.array(p.calculateInverseDynamics(robot, [*place, *q[7:]], v.tolist(), a.tolist()))
    return about.T @ np.r_[forces[3:6], forces[:3], forces[6:]]
def stand(q, v):
    R = np.reshape(p.getMatrixFromQuaternion(q[3:7]), (3, 3))
    p.resetBasePositionAndOrientation(robot, *p.multiplyTransforms(q[:3], q[3:7], *base[3:5]))
    p.resetBaseVelocity(robot, R @ (v[:3] + np.cross(v[3:6], centre)), R @ v[3:6])
    place = p.getBasePositionAndOrientation(robot)
    link = p.multiplyTransforms(*place, *p.invertTransform(*base[3:5]))
    return *place, *base[3:5], *link, *p.getBaseVelocity(robot)
q = np.array([0.0, 0.0, 0.0, 0.6, 0.8, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
gravity
value = inverse_dynamics(q, *[[0.0] * len(v)] * 2)
import numpy as np
value, expected = np.reshape(value, (6,))[(0,)], 6.6000000000000005
assert abs(value - expected) <= 1.6e-11, f"{value = }, {expected = }"
