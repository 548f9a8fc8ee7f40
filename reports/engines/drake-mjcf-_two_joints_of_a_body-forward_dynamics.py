# drake 1.51.1, mjcf: two joints of a body: EvalTimeDerivatives is wrong (M^-1 (tau - h)).
import numpy as np, pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString("""<mujoco model="r"><compiler angle="radian"/><worldbody><body name="a">
<joint axis="0.6 0 0.8"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><body name="b" pos="0 0 0.5">
<joint axis="0 1 0"/><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
</body></worldbody></mujoco>""", 'xml')
p.Finalize()
c = p.CreateDefaultContext()
q = np.zeros(3)
p.SetPositions(c, q)
p.get_applied_generalized_force_input_port().FixValue(c, np.eye(3)[2])
value, expected = p.EvalTimeDerivatives(c).CopyToVector()[len(q):][1], 0.0
assert abs(value - expected) <= 1.8e-12, f'value = {value!r}, expected = {expected!r}'
