# drake 1.51.1, mjcf: armature by default: CalcMassMatrix is wrong (M).
# Known: https://github.com/RobotLocomotion/drake/pull/21967.
import numpy as np, pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString("""<mujoco model="r"><compiler angle="radian"/><default><joint armature="0.5"/>
</default><worldbody><body name="a"><joint axis="0.6 0 0.8"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
</body></worldbody></mujoco>""", 'xml')
p.Finalize()
c = p.CreateDefaultContext()
value, expected = p.CalcMassMatrix(c)[0, 0], 1.5
assert abs(value - expected) <= 1.5e-12, f'value = {value!r}, expected = {expected!r}'
