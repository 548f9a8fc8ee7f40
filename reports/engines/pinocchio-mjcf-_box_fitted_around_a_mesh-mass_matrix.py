# pinocchio 4.1.0, mjcf: box fitted around a mesh: crba is wrong (M).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian" fitaabb="true"/><asset><mesh name="t" vertex="0.0 -0.25 -0.5  0.0 0.25 -0.5  0.0 0.25 0.5  0.0 -0.25 0.5  2.0 0.0 0.0" face="0 2 1  0 3 2  0 1 4  1 2 4  2 3 4  3 0 4"/></asset><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><geom type="box" mesh="t"/></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
q = np.array([0.0, -1.8914015371177906])
value = pin.crba(m, d, q)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 1)], 1416.6666666666667
assert abs(value - expected) <= 3.0e-09, f"{value = }, {expected = }"
