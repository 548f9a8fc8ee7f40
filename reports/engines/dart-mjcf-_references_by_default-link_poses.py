# dart 6.20.0, mjcf: references by default: getTransform is wrong (positions and rows of R).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian" /><option /><default><joint ref="0.25" /></default><worldbody><body name="a" pos="0.1 0.2 0.3"><joint name="a" axis="0 0 1" /><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4" /><body name="b" pos="0 0 0.5"><joint name="b" axis="0 1 0" /><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4" /></body></body></worldbody></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b'] if (b := s.getBodyNode(name))]
q = np.array([0.0, 0.0])
s.setPositions(q)
X = [b.getTransform() for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
import numpy as np
value, expected = np.reshape(value, (2, 12))[(0, 4)], 0.24740395925452294
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
