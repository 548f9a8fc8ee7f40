# drake 1.51.1, base 10 km away: CalcSpatialInertia is imprecise (momentum of each link with all it carries, as one body, for twists of its frame along its axes).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
def X(R, r): return drake.RigidTransform(drake.RotationMatrix(np.array(R)), r)
def inertia(mass, com, I):
    if mass == 0 and not np.any(I): return drake.SpatialInertia.Zero()
    I = np.array(I)
    about = drake.RotationalInertia(*I.diagonal(), I[0, 1], I[0, 2], I[1, 2])
    return drake.SpatialInertia.MakeFromCentralInertia(mass, com, about)
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
b0 = p.AddRigidBody('a', inertia(1.8187017420963922, [-0.043751762992496473, -0.1844729293362066, 0.1707799604227791], ((0.07404893536252394, 0.011777050735461883, 0.005841387202879444), (0.011777050735461883, 0.10741947676947003, -0.003784782121519158), (0.005841387202879444, -0.003784782121519158, 0.12648701812474122))))
j0 = p.AddJoint(drake.RevoluteJoint('j0', p.AddFrame(drake.FixedOffsetFrame('P0', p.world_body(), X([[-0.022500291568026905, 0.975816140144018, 0.21743182267962521], [-0.27506996321534877, 0.20305028385882, -0.9397377812781389], [-0.9611608877893755, -0.08095333754257956, 0.26384901918456455]], [6400.0, -4800.0, 6000.0]))), b0.body_frame(), [0.0, 0.0, 1.0]))
p.Finalize()
links = [b0]
parents = [-1]
js = [p.GetJointByName(f'j{k}') for k in range(1)]
c = p.CreateDefaultContext()
q = np.array([-1.0996201868492035])
p.SetPositions(c, q)
value = []
def below(b): return [b.index()] + [k for x in links if parents[links.index(x)] == links.index(b) for k in below(x)]
for b in links:
    K = p.CalcSpatialInertia(c, b.body_frame(), below(b))
    value.append(np.roll(K.CopyToFullMatrix6(), (3, 3), (0, 1)))
import numpy as np
value, expected = np.reshape(value, (1, 6, 6))[(0, 3, 4)], -0.0029017199111637188
assert abs(value - expected) <= 2.7e-12, f"{value = }, {expected = }"
