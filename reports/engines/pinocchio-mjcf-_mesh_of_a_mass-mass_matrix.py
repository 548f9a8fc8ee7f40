# pinocchio 4.1.0, mjcf: mesh of a mass: crba is wrong (M).
# Known: https://github.com/stack-of-tasks/pinocchio/pull/2537 (reads such meshes as geometry; says nothing of their inertia).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian"/><asset><mesh name="t" vertex="0.0 0.0 0.0  0.5 0.0 0.0  0.0 0.25 0.0  0.5 0.25 0.0  0.0 0.0 0.75  0.5 0.0 0.75  0.0 0.25 0.75  0.5 0.25 0.75" face="0 2 3  0 3 1  4 5 7  4 7 6  0 1 5  0 5 4  2 6 7  2 7 3  0 4 6  0 6 2  1 3 7  1 7 5" /></asset><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><geom type="mesh" mesh="t" mass="3"/></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
q = np.array([0.0, 0.0])
value = pin.crba(m, d, q)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 0)], 0.8125
assert abs(value - expected) <= 1.8e-12, f"{value = }, {expected = }"
