# newton 1.8.0, mjcf: actuator: motor by default of a general one: mujoco.actuator_trnid is wrong (their derivatives (nu, nv)).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
import newton
TEXT = '<mujoco model="m"><compiler angle="radian"/><default><general gear="3"/></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint name="a" axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><site name="n" pos="0.25 0 -0.5"/><body name="b" pos="0 0 0.5" ><joint name="b" axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/><site name="o" pos="0 0.125 0.5"/></body></body></worldbody><actuator><motor joint="b"/></actuator></mujoco>'
b = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(b)
b.add_mjcf(TEXT)
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['a', 'b']]
v = np.array([0.0, -0.8567209055906702])
arms = np.zeros((len(m.mujoco.tendon_stiffness) if hasattr(m.mujoco, 'tendon_joint') else 0, len(v)))
def part(name): return getattr(m.mujoco, 'tendon_' + name).numpy()
for k in range(len(arms)):
    for place in range(part('joint_adr')[k], part('joint_adr')[k] + part('joint_num')[k]):
        arms[k, m.joint_qd_start.numpy()[part('joint')[place]]] += part('coef')[place]
value = np.zeros((len(m.mujoco.actuator_gear), len(v)))
kinds, targets = m.mujoco.actuator_trntype.numpy(), m.mujoco.actuator_trnid.numpy()[:, 0]
for row, kind, k, gear in zip(value, kinds, targets, m.mujoco.actuator_gear.numpy()):
    if kind == 2: row += gear[0] * arms[k]
    else: row[k] = gear[0]
import numpy as np
value, expected = np.reshape(value, (1, 2))[(0, 1)], 3.0
assert abs(value - expected) <= 1.6e-03, f"{value = }, {expected = }"
