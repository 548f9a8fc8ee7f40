# drake 1.51.1, mjcf: total mass set: CalcInverseDynamics is wrong (h: Coriolis, centrifugal and gravity forces).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian" settotalmass="6"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 1.0])
v = np.array([0.0, 0.0])
p.SetPositions(c, q)
p.SetVelocities(c, v)
forces = drake.MultibodyForces(p)
p.CalcForceElementsContribution(c, forces)
value = p.CalcInverseDynamics(c, 0 * v, forces)
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -3.3019321443861864
assert abs(value - expected) <= 2.0e-11, f"{value = }, {expected = }"
