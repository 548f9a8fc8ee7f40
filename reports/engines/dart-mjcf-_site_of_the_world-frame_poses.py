# dart 6.20.0, mjcf: site of the world: SimpleFrame.getTransform crashes (positions and rows of R (n, 12)).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.xml')
print('<mujoco model="m"><compiler angle="radian"/><worldbody><site name="o0" pos="0.1 -0.2 0.3" euler="0.5 0.6 0.7"/><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', file=file, flush=True)
world = dart.utils.MjcfParser.readWorld(dart.common.Uri('file://' + file.name))
s = world and world.getSkeleton(0)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b'] if (b := s.getBodyNode(name))]
