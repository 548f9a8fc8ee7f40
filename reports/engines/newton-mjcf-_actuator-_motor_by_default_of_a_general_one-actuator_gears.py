# newton 1.8.0, mjcf: actuator: motor by default of a general one: mujoco.actuator_gear is wrong (factors of lengths and forces (nu)).
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
value = m.mujoco.actuator_gear.numpy()[:, 0]
import numpy as np
value, expected = np.reshape(value, (1,))[(0,)], 3.0
assert abs(value - expected) <= 1.6e-03, f"{value = }, {expected = }"
