# drake 1.51.1, mjcf: shell of a box: CalcMassMatrix is wrong (M).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><geom type="box" size="0.1 0.2 0.3" shellinertia="true" density="6" /></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 0.0])
p.SetPositions(c, q)
value = p.CalcMassMatrix(c)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 1)], 0.25279999999999997
assert abs(value - expected) <= 9.8e-13, f"{value = }, {expected = }"
