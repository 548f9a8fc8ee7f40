# dart 6.20.0, sdf: moments left out: getMassMatrix is wrong (M).
import numpy as np
import dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.sdf')
print('<sdf version="1.6"><model name="m"><link name="a"><pose>0.1 0.2 0.3 0.3 -0.4 0.5</pose><inertial><pose>0.1 -0.2 0.3 0 0 0</pose><mass>2</mass></inertial></link><joint name="ja" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 0 1</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit></axis></joint></model></sdf>', file=file, flush=True)
options = dart.utils.SdfParser.Options(None, dart.utils.SdfParser.RootJointType.FIXED)
s = dart.utils.SdfParser.readSkeleton(dart.common.Uri('file://' + file.name), options)
if s is None: raise ValueError('no skeleton: see the log')
links = [s.getBodyNode(name) for name in ['a']]
q = np.array([0.0])
s.setPositions(q)
value = s.getMassMatrix()
import numpy as np
value, expected = np.reshape(value, (1, 1))[(0, 0)], 1.1
assert abs(value - expected) <= 2.0e-12, f"{value = }, {expected = }"
