# drake 1.51.1, mjcf: spring: CalcForceElementsContribution is wrong (forces of springs, dampers, compensated weights).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" stiffness="7" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 1.0])
v = np.array([0.0, 0.0])
p.SetPositions(c, q)
p.SetVelocities(c, v)
forces = drake.MultibodyForces(p)
p.CalcForceElementsContribution(c, forces)
zero = 0 * v
value = p.CalcInverseDynamics(c, zero, drake.MultibodyForces(p)) - p.CalcInverseDynamics(c, zero, forces) - p.CalcGravityGeneralizedForces(c)
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -7.0
assert abs(value - expected) <= 1.2e-11, f"{value = }, {expected = }"
