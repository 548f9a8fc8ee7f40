# pinocchio 4.1.0, mjcf: oblique gravity: nonLinearEffects is wrong (h: Coriolis, centrifugal and gravity forces).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian" /><option gravity="1 -2 -3" /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
value = pin.nonLinearEffects(m, d, q, v)
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -0.2
assert abs(value - expected) <= 4.2e-12, f"{value = }, {expected = }"
