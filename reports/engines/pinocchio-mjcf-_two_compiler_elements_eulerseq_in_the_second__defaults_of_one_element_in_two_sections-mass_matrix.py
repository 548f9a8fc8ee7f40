# pinocchio 4.1.0, mjcf: two compiler elements, eulerseq in the second + defaults of one element in two sections: crba is wrong (M).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3" euler="0.3 -0.4 0.5"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody><compiler eulerseq="zyx" /><default><joint damping="3" /></default><default><joint armature="0.5" /></default></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
q = np.array([0.0, 0.0])
value = pin.crba(m, d, q)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 0)], 1.4100000000000001
assert abs(value - expected) <= 1.6e-12, f"{value = }, {expected = }"
