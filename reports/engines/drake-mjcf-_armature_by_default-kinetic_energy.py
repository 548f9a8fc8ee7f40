# drake 1.51.1, mjcf: armature by default: CalcKineticEnergy is wrong (T = v^T M v / 2).
# Known: https://github.com/RobotLocomotion/drake/pull/21967.
import numpy as np, pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString("""<mujoco model="r"><compiler angle="radian"/><default><joint armature="0.5"/>
</default><worldbody><body name="a"><joint axis="0.6 0 0.8"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
</body></worldbody></mujoco>""", 'xml')
p.Finalize()
c = p.CreateDefaultContext()
p.SetVelocities(c, np.array([1.0]))
value, expected = p.CalcKineticEnergy(c), 0.75
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
