# dart 6.20.0, mjcf: two hinges with anchors + defaults of one element in two sections: getDampingCoefficient is wrong (force of dampers for a unit of speed).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian" /><option /><default /><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" pos="0 -0.1 0.2" /><joint axis="1 0 0" pos="0.3 0 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody><default><joint damping="3" /></default><default><joint armature="0.5" /></default></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b'] if (b := s.getBodyNode(name))]
value = [s.getDof(k).getDampingCoefficient() for k in range(s.getNumDofs())]
import numpy as np
value, expected = np.reshape(value, (3,))[(0,)], 3.0
assert abs(value - expected) <= 3.0e-12, f"{value = }, {expected = }"
