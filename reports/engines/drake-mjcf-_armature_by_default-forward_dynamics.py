# drake 1.51.1, mjcf: armature by default: EvalTimeDerivatives is wrong (M^-1 (tau - h)).
# Known: https://github.com/RobotLocomotion/drake/pull/21967.
import numpy as np, pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString("""<mujoco model="r"><compiler angle="radian"/><default><joint armature="0.5"/>
</default><worldbody><body name="a"><joint axis="0.6 0 0.8"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
</body></worldbody></mujoco>""", 'xml')
p.Finalize()
c = p.CreateDefaultContext()
q = np.zeros(1)
p.SetPositions(c, q)
p.get_applied_generalized_force_input_port().FixValue(c, np.array([1.0]))
value, expected = p.EvalTimeDerivatives(c).CopyToVector()[len(q):][0], 0.6666666666666666
assert abs(value - expected) <= 9.8e-13, f'value = {value!r}, expected = {expected!r}'
