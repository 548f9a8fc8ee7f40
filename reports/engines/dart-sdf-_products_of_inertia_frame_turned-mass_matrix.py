# dart 6.20.0, sdf: products of inertia, frame turned: getMassMatrix is wrong (M).
# Known: https://github.com/dartsim/dart/issues/47 (the same in the reader of URDF, mended in 2015).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.sdf')
print('<sdf version="1.6"><model name="m"><link name="a"><pose>0.1 0.2 0.3 0.3 -0.4 0.5</pose><inertial><pose>0.1 -0.2 0.3 0.5 0.6 0.7</pose><mass>2</mass><inertia><ixx>0.21</ixx><iyy>0.32</iyy><izz>0.43</izz><ixy>0.01</ixy><ixz>-0.02</ixz><iyz>0.03</iyz></inertia></inertial></link><link name="b"><pose>0.25 -0.125 0.75 -0.2 0.1 0.6</pose><inertial><pose>0 0.1 0.2 0 0 0</pose><mass>1</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link><joint name="ja" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 0 1</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit></axis></joint><joint name="jb" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit></axis></joint></model></sdf>', file=file, flush=True)
options = dart.utils.SdfParser.Options(None, dart.utils.SdfParser.RootJointType.FIXED)
s = dart.utils.SdfParser.readSkeleton(dart.common.Uri('file://' + file.name), options)
if s is None: raise ValueError('no skeleton: see the log')
links = [b for name in ['a', 'b'] if (b := s.getBodyNode(name))]
q = np.array([0.0, 0.0])
s.setPositions(q)
value = s.getMassMatrix()
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 0)], 0.8588979196071646
assert abs(value - expected) <= 1.1e-12, f"{value = }, {expected = }"
