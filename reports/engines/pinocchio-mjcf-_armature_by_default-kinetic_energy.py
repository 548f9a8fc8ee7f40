"""pinocchio 4.1.0: computeKineticEnergy, mjcf: armature by default.

Result: T = v^T M v / 2.
Known: none found.
"""

import numpy as np
import pinocchio as pin
TEXT = '<mujoco><compiler angle="radian"/><default><joint armature="0.5"/></default><worldbody><body name="a" pos="0.1 0.2 0.3"><joint axis="0.6 0 0.8"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5"><joint axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
d = m.createData()
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([-0.1816631824515902, -0.8567209055906702])
value = pin.computeKineticEnergy(m, d, q, v)
value = np.array(value, dtype=float)
expected = 0.33465869910963036
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 6.1e-13
