# drake 1.51.1, mjcf: two hinges with anchors + defaults of one element in two sections: CalcGravityGeneralizedForces is wrong (g: gravity forces).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" pos="0 -0.1 0.2" /><joint axis="1 0 0" pos="0.3 0 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody><default><joint damping="3" /></default><default><joint armature="0.5" /></default></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 1.0, 0.0])
p.SetPositions(c, q)
value = -p.CalcGravityGeneralizedForces(c)
import numpy as np
value, expected = np.reshape(value, (3,))[(1,)], -3.9981937163114237e-28
assert abs(value - expected) <= 1.2e-11, f"{value = }, {expected = }"
