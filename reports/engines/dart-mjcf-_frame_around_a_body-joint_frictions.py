# dart 6.20.0, mjcf: frame around a body: getCoulombFriction is wrong (greatest force of dry friction).
# shape (1,), not (2,).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><frame pos="0.125 -0.25 0.5" euler="0.3 -0.4 0.5"><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></frame></body></worldbody></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b'] if (b := s.getBodyNode(name))]
value = [s.getDof(k).getCoulombFriction() for k in range(s.getNumDofs())]
import numpy as np
assert np.shape(value) == (2,), np.shape(value)
