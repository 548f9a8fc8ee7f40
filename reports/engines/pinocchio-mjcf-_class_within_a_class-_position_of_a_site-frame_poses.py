# pinocchio 4.1.0, mjcf: class within a class: position of a site: framesForwardKinematics is wrong (positions and rows of R (n, 12)).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian"/><default><default class="k"><site pos="0.1 -0.2 0.3"/><default class="p"/></default></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge" axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" childclass="k"><joint axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/><site name="o0" class="p"/></body></body></worldbody></mujoco>'
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
value, expected = np.reshape(value, (1, 12))[(0, 2)], 1.1
assert abs(value - expected) <= 1.5e-12, f"{value = }, {expected = }"
