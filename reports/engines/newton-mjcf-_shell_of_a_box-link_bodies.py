# newton 1.8.0, mjcf: shell of a box: body_mass, body_com, body_inertia is wrong (mass, mass times mass centre, moments about it xx, yy, zz, xy, xz, yz along the link's axes).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
wp.config.enable_backward, wp.config.optimization_level = False, 0
import newton
TEXT = '<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><geom type="box" size="0.1 0.2 0.3" shellinertia="true" density="6" /></body></body></worldbody></mujoco>'
b = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(b)
b.add_mjcf(TEXT)
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['a', 'b']]
value = [[mass, *(mass * com), *I[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]] for mass, com, I in zip(
    m.body_mass.numpy()[bodies], m.body_com.numpy()[bodies], m.body_inertia.numpy()[bodies])]
import numpy as np
value, expected = np.reshape(value, (2, 10))[(1, 0)], 5.28
assert abs(value - expected) <= 3.8e-03, f"{value = }, {expected = }"
