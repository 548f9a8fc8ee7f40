# drake 1.51.1, mjcf: geoms beside inertia, inertiafromgeom true: CalcMassMatrix is wrong (M).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian" inertiafromgeom="true" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /><geom type="box" size="0.1 0.2 0.3" mass="9" /></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 0.0])
p.SetPositions(c, q)
value = p.CalcMassMatrix(c)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 0)], 0.65
assert abs(value - expected) <= 9.7e-13, f"{value = }, {expected = }"
