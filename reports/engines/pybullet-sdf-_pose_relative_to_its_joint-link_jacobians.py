# pybullet 3.2.7, sdf: pose relative to its joint: calculateJacobian crashes (Jacobians of the links).
from tempfile import NamedTemporaryFile
import pybullet as p
p.isConnected() or p.connect(p.DIRECT)
file = NamedTemporaryFile('w', suffix='.sdf')
print("""<sdf version="1.9"><model name="m"><link name="a"><pose relative_to="ja"/><inertial>
<pose>0.1 -0.2 0.3 0 0 0</pose><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.3</iyy><izz>0.4</izz></inertia>
</inertial></link><joint name="ja" type="revolute"><pose relative_to="__model__">0.1 0.2 0.3 0.3 -0.4 0.5</pose>
<parent>world</parent><child>a</child><axis><xyz>0.6 0 0.8</xyz><limit><lower>-9</lower><upper>9</upper>
<effort>9</effort><velocity>9</velocity></limit></axis></joint></model></sdf>""", file=file, flush=True)
robot = p.loadSDF(file.name)[0]
