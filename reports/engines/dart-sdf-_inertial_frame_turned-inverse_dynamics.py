# dart 6.20.0, sdf: inertial frame turned: computeInverseDynamics is wrong (M a + h).
import numpy as np, dartpy as dart
from tempfile import NamedTemporaryFile
file = NamedTemporaryFile('w', suffix='.sdf')
print("""<sdf version="1.6"><model name="m"><link name="a"><pose>0.1 0.2 0.3 0.3 -0.4 0.5</pose><inertial>
<pose>0.1 -0.2 0.3 0.5 0.6 0.7</pose><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz><ixy>0</ixy>
<ixz>0</ixz><iyz>0</iyz></inertia></inertial></link><joint name="ja" type="revolute"><parent>world</parent>
<child>a</child><axis><xyz>0.6 0 0.8</xyz><limit><lower>-9</lower><upper>9</upper><effort>9</effort>
<velocity>9</velocity></limit></axis></joint></model></sdf>""", file=file, flush=True)
options = dart.utils.SdfParser.Options(None, dart.utils.SdfParser.RootJointType.FIXED)
s = dart.utils.SdfParser.readSkeleton(dart.common.Uri('file://' + file.name), options)
if s is None:
    raise ValueError('no skeleton: see the log')
s.setAccelerations(np.array([1.0]))
s.computeInverseDynamics()
value, expected = s.getForces()[0], -0.8853662938437284
assert abs(value - expected) <= 9.1e-13, f'value = {value!r}, expected = {expected!r}'
