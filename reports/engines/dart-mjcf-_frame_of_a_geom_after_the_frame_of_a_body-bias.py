# dart 6.20.0, mjcf: frame of a geom after the frame of a body: getCoriolisAndGravityForces is wrong (h: Coriolis, centrifugal and gravity forces).
# shape (2,), not (3,).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><frame pos="0 0.4 0"><body name="c"><joint axis="0 0 1"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></frame><frame pos="0.2 0 0"><geom size="0.1" mass="5"/></frame></body></body></worldbody></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b', 'c'] if (b := s.getBodyNode(name))]
q = np.array([0.0, 0.0, 0.0])
v = np.array([0.0, 0.0, 0.0])
s.setPositions(q)
s.setVelocities(v)
value = s.getCoriolisAndGravityForces()
import numpy as np
assert np.shape(value) == (3,), np.shape(value)
