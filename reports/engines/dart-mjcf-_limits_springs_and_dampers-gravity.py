# dart 6.20.0, mjcf: limits, springs and dampers: getGravityForces is wrong (g: gravity forces).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0" range="-1 1" damping="3" stiffness="7" springref="0.4" frictionloss="0.3"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [s.getBodyNode(name) for name in ['a', 'b']]
q = np.array([0.0, 1.0])
s.setPositions(q)
value = s.getGravityForces()
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -1.6509660721930932
assert abs(value - expected) <= 1.0e-11, f"{value = }, {expected = }"
