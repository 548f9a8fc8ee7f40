# drake 1.51.1, mjcf: two sections of defaults: CalcMassMatrix is wrong (M).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian"/><default><joint armature="0.5"/></default><default><geom density="500"/></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, -1.8914015371177906])
p.SetPositions(c, q)
value = p.CalcMassMatrix(c)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 0)], 1.2658902149770754
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
