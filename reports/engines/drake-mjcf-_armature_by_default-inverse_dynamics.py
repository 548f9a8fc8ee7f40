# drake 1.51.1, mjcf: armature by default: CalcInverseDynamics is wrong (M a + h).
# Known: https://github.com/RobotLocomotion/drake/pull/21967.
import numpy as np, pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString("""<mujoco model="r"><compiler angle="radian"/><default><joint armature="0.5"/>
</default><worldbody><body name="a"><joint axis="0.6 0 0.8"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
</body></worldbody></mujoco>""", 'xml')
p.Finalize()
c = p.CreateDefaultContext()
forces = drake.MultibodyForces(p)
p.CalcForceElementsContribution(c, forces)
value, expected = p.CalcInverseDynamics(c, np.array([1.0]), forces)[0], 1.5
assert abs(value - expected) <= 2.1e-12, f'value = {value!r}, expected = {expected!r}'
