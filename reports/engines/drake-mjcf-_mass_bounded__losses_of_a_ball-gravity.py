# drake 1.51.1, mjcf: mass bounded + losses of a ball: CalcGravityGeneralizedForces is wrong (g: gravity forces).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian" boundmass="1.5" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" type="ball" damping="3" frictionloss="0.25" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 0.0, 0.0, 0.0])
p.SetPositions(c, q)
value = -p.CalcGravityGeneralizedForces(c)
import numpy as np
value, expected = np.reshape(value, (4,))[(1,)], 1.4715000000000003
assert abs(value - expected) <= 1.2e-11, f"{value = }, {expected = }"
