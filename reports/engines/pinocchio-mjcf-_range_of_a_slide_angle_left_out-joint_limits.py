# pinocchio 4.1.0, mjcf: range of a slide, angle left out: lowerPositionLimit, upperPositionLimit is wrong (least and greatest coordinates).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1" range="-57.29577951308232 42.97183463481174"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint type="slide" axis="1 0 0" range="-0.25 2"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
value = np.c_[m.lowerPositionLimit, m.upperPositionLimit]
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 1)], 2.0
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
