# pinocchio 4.1.0, mjcf: range without limits: limited false: lowerPositionLimit, upperPositionLimit is wrong (the same where not all joints have limits: zeros for none).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" range="-0.5 1.25" limited="false" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
x, value = np.c_[m.lowerPositionLimit, m.upperPositionLimit], np.zeros((m.nv, 2))
for j in m.joints[1:]:
    if j.nq == j.nv:
        own = x[j.idx_q : j.idx_q + j.nq]
        value[j.idx_v : j.idx_v + j.nv] = np.where(np.abs(own) < 1e300, own, 0.0)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 1)], 0.0
assert abs(value - expected) <= 9.0e-13, f"{value = }, {expected = }"
