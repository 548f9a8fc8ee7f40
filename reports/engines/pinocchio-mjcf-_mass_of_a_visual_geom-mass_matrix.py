# pinocchio 4.1.0, mjcf: mass of a visual geom: crba is wrong (M).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><geom size="0.1" mass="2" contype="0" conaffinity="0" group="2"/></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
q = np.array([0.0, 0.0])
value = pin.crba(m, d, q)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 0)], 0.508
assert abs(value - expected) <= 1.1e-12, f"{value = }, {expected = }"
