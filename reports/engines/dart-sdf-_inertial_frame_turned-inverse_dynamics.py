"""dart 6.20.0: computeInverseDynamics, sdf: inertial frame turned.

Result: M a + h (nv).
Known: none found.
"""

import numpy as np
import dartpy as dart
dy = dart.dynamics
def state(q, v=None, a=None):
    s.setPositions(q)
    s.setVelocities(np.zeros(len(q)) if v is None else v)
    s.setAccelerations(np.zeros(len(q)) if a is None else a)
W = dy.Frame.World()
TEXT = '<sdf version="1.6"><model name="m"><link name="a"><pose>0.1 0.2 0.3 0.3 -0.4 0.5</pose><inertial><pose>0.1 -0.2 0.3 0.5 0.6 0.7</pose><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link><joint name="ja" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0.6 0 0.8</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit></axis></joint></model></sdf>'
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.sdf')
print(TEXT, file=file, flush=True)
options = dart.utils.SdfParser.Options(None, dart.utils.SdfParser.RootJointType.FIXED)
s = dart.utils.SdfParser.readSkeleton(dart.common.Uri('file://' + file.name), options)
if s is None: raise ValueError('no skeleton: see the log')
s.setGravity([0.0, 0.0, -9.81])
links = [s.getBodyNode(name) for name in ['a']]
q = np.array([-1.0996201868492035])
v = np.array([-0.7565606148471162])
a = np.array([0.04521670343786499])
state(q, v, a)
s.computeInverseDynamics()
value = s.getForces()
value = np.array(value, dtype=float)
expected = np.array([-1.1787525271221224])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 1.5e-12
