# drake 1.51.1, defaults and parameters: gears, rotors, dampers, model instances: SetDefaultPositions, Clone is wrong (coordinates, once they are set).
import numpy as np
import numpy as np
import pydrake.all as drake
v = np.array([0.0, 0.0, 1.0])
p = drake.MultibodyPlant(0.0)
p.mutable_gravity_field().set_gravity_vector([1.0, -2.0, -9.0])
one, two = p.AddModelInstance('one'), p.AddModelInstance('two')
def slide(name, model, mass, axis, parent):
    b = p.AddRigidBody(name, model, drake.SpatialInertia(mass, np.zeros(3), drake.UnitInertia(1.0, 1.0, 1.0)))
    return p.AddJoint(drake.PrismaticJoint(name, parent, b.body_frame(), axis)), b
(jx, bx), (jz, bz) = slide('x', one, 2.0, [1, 0, 0], p.world_frame()), slide('z', two, 5.0, [0, 0, 1], p.world_frame())
jy, by = slide('y', one, 3.0, [0, 1, 0], bx.body_frame())
jj = (jx, jy, jz)
p.Finalize()
c = p.CreateDefaultContext()
qs, vs = ([getattr(j, name)() for j in jj] for name in ('position_start', 'velocity_start'))
p.SetDefaultPositions(two, v[2:])
p.SetDefaultPositions(one, v[:2])
p = p.Clone()
c = p.CreateDefaultContext()
value = np.r_[p.GetPositions(c, one), p.GetPositions(c, two)]
import numpy as np
value, expected = np.reshape(value, (3,))[(2,)], 1.0
assert abs(value - expected) <= 1.4e-12, f"{value = }, {expected = }"
