# pinocchio 4.1.0, mjcf: axisangle of an axis of length 2 + site turned: framesForwardKinematics is wrong (positions and rows of R (n, 12)).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5" axisangle="1.2 0 1.6 0.7"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /><site name="o0" pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7" /></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
sensed = [m.getFrameId(f'o{k}') for k in range(1)]
d = m.createData()
q = np.array([0.0, 0.0])
pin.framesForwardKinematics(m, d, q)
at = [d.oMf[f] if f < m.nframes else None for f in sensed]
value = [[*X.translation, *X.rotation.flat] if X else [np.nan] * 12 for X in at]
import numpy as np
value, expected = np.reshape(value, (1, 12))[(0, 7)], -0.15915788414303772
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
