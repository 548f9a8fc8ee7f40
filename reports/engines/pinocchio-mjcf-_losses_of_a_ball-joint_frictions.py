# pinocchio 4.1.0, mjcf: losses of a ball: friction, upperDryFrictionLimit is wrong (greatest force of dry friction).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint type="ball" damping="3" frictionloss="0.3"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
value = m.friction if hasattr(m, 'friction') else m.upperDryFrictionLimit
import numpy as np
value, expected = np.reshape(value, (4,))[(1,)], 0.3
assert abs(value - expected) <= 9.0e-13, f"{value = }, {expected = }"
