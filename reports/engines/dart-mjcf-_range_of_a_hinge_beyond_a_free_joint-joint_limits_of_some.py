# dart 6.20.0, mjcf: range of a hinge beyond a free joint: getPositionLowerLimits, getPositionUpperLimits is wrong (the same where not all joints have limits: zeros for none).
# shape (1, 2), not (7, 2).
# Known: https://github.com/dartsim/dart/pull/2505 (mends it beyond 6.20.0).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><freejoint/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0" range="-0.5 1.25"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b'] if (b := s.getBodyNode(name))]
x = np.c_[s.getPositionLowerLimits(), s.getPositionUpperLimits()]
value = np.where(np.isfinite(x), x, 0.0)
import numpy as np
assert np.shape(value) == (7, 2), np.shape(value)
