# dart 6.20.0, mjcf: gravity of unit masses: getCoriolisAndGravityForces is wrong (h: Coriolis, centrifugal and gravity forces).
# Known: https://github.com/dartsim/dart/pull/2505.
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian"/><option gravity="1 -2 -3"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><body name="b" pos="0 0 0.5" ><joint type="slide" axis="0 1 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></body></worldbody></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b'] if (b := s.getBodyNode(name))]
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
s.setPositions(q)
s.setVelocities(v)
value = s.getCoriolisAndGravityForces()
import numpy as np
value, expected = np.reshape(value, (2,))[(0,)], 6.0
assert abs(value - expected) <= 7.6e-12, f"{value = }, {expected = }"
