# pinocchio 4.1.0, mjcf: frame around a body: friction, upperDryFrictionLimit is wrong (greatest force of dry friction).
# shape (1,), not (2,).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><frame pos="0.125 -0.25 0.5" euler="0.3 -0.4 0.5"><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></frame></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
value = m.friction if hasattr(m, 'friction') else m.upperDryFrictionLimit
import numpy as np
assert np.shape(value) == (2,), np.shape(value)
