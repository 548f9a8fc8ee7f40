# pinocchio 4.1.0, mjcf: class of nothing below childclass: axis: framesForwardKinematics is wrong (positions and rows of R).
import numpy as np
import pinocchio as pin
TEXT = '<mujoco model="m"><compiler angle="radian"/><default><default class="k"><joint axis="1 0 0"/></default><default class="p"/></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge" axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" childclass="k"><joint class="p"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
fs = [m.getFrameId(name, pin.FrameType.BODY) for name in ['a', 'b']]
d = m.createData()
q = np.array([0.0, 1.0])
pin.framesForwardKinematics(m, d, q)
value = np.array([np.r_[d.oMf[f].translation, d.oMf[f].rotation.ravel()] for f in fs])
import numpy as np
value, expected = np.reshape(value, (2, 12))[(1, 4)], -0.8414709848078965
assert abs(value - expected) <= 1.7e-12, f"{value = }, {expected = }"
