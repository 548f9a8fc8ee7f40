"""drake 1.51.1: CalcInverseDynamics, AutoDiffXd, huge before tiny masses.

Result: derivative of M a + h by v (nv, nv).
Known: none found.
"""

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody import tree
from pydrake.multibody.plant import MultibodyPlant
p = MultibodyPlant(0.0)
def X(R, r): return RigidTransform(RotationMatrix(np.array(R)), r)
def inertia(mass, com, I):
    if mass == 0 and not np.any(I): return tree.SpatialInertia.Zero()
    I = np.array(I)
    about = tree.RotationalInertia(*I.diagonal(), I[0, 1], I[0, 2], I[1, 2])
    return tree.SpatialInertia.MakeFromCentralInertia(mass, com, about)
def frame(name, body, R, r): return p.AddFrame(tree.FixedOffsetFrame(name, body, X(R, r)))
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -9.81])
b0 = p.AddRigidBody('a', inertia(149152914.1632119, [-0.043857032141920355, -0.025771785288849852, 0.18949070573878773], ((9765779.852048708, 303033.19644972915, 392273.05491541413), (303033.19644972915, 13379296.16581072, 997742.3511289496), (392273.05491541413, 997742.3511289496, 10444614.484902823))))
j0 = p.AddJoint(tree.RevoluteJoint('j0', frame('P0', p.world_body(), [[-0.7123319323378645, 0.3461162623941064, 0.6105626512309265], [-0.6485637432245976, 0.007854782407637784, -0.7611198153824579], [-0.268231782505918, -0.9381587473874892, 0.21888324639870263]], [-0.10630118327969384, 0.4338787789537393, 0.22442791313431198]), b0.body_frame(), [0.6666666666666666, -0.3333333333333333, 0.6666666666666666]))
b1 = p.AddRigidBody('b', inertia(1.8591085792217488, [-0.1283722546678156, 0.0949056874359388, 0.10892053953403968], ((0.096539397300591, -0.005210450773638082, 0.010080265189673521), (-0.005210450773638082, 0.0944448580153586, -0.010289222977134582), (0.010080265189673521, -0.010289222977134582, 0.10898194686955136))))
j1 = p.AddJoint(tree.RevoluteJoint('j1', frame('P1', b0, [[-0.8754534028247707, 0.48096200170430886, 0.04750676161468099], [-0.46911595340006684, -0.8692818949570108, 0.15581787241999767], [0.11623924358010955, 0.11412510686318217, 0.9866427409328016]], [-0.29201092170432674, 0.13683653478638447, 0.463003385311357]), b1.body_frame(), [0.6666666666666666, -0.3333333333333333, 0.6666666666666666]))
b2 = p.AddRigidBody('c', inertia(1.0037841658760902e-08, [-0.019364999761275092, 0.09971227485872952, 0.04898263116168783], ((8.293886664275547e-10, 4.463102279402807e-11, 1.7191491387894826e-12), (4.463102279402807e-11, 1.0777446711564957e-09, 1.6169041300888298e-11), (1.7191491387894826e-12, 1.6169041300888298e-11, 7.448261148841643e-10))))
j2 = p.AddJoint(tree.RevoluteJoint('j2', frame('P2', b1, [[-0.617767856145274, -0.7325495077352964, 0.28589175334459543], [0.10842688413798594, -0.43944219809361934, -0.8917029580139206], [0.7788494634457931, -0.519867072674759, 0.3509013252166157]], [0.34367642557584577, 0.11571147817626115, -0.4279731263960814]), b2.body_frame(), [0.6666666666666666, -0.3333333333333333, 0.6666666666666666]))
p.Finalize()
c = p.CreateDefaultContext()
W = p.world_frame()
def state(q, v=None):
    p.SetPositions(c, q)
    p.SetVelocities(c, np.zeros(p.num_velocities()) if v is None else v)
def forces():
    applied = tree.MultibodyForces(p)
    p.CalcForceElementsContribution(c, applied)
    return applied
def jacobian(b, about, speeds=tree.JacobianWrtVariable.kV):
    return np.roll(p.CalcJacobianSpatialVelocity(c, speeds, b.body_frame(), [0, 0, 0], W, about), 3, axis=0)
links = [b0, b1, b2]
q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
v = np.array([-0.8020666483629364, 0.9725767279334938, 0.3881357647151733])
a = np.array([-0.10262307947376259, 0.280353617179524, -0.45902228709100545])
from pydrake.autodiffutils import AutoDiffXd, ExtractGradient, InitializeAutoDiff
ad = p.ToAutoDiffXd()
d = ad.CreateDefaultContext()
state(q, v)
N = p.MakeVelocityToQDotMap(c).toarray()
q_ = InitializeAutoDiff(q, 0 * N).flatten()
v_ = InitializeAutoDiff(v, np.eye(len(v))).flatten()
ad.SetPositions(d, q_)
ad.SetVelocities(d, v_)
from pydrake.multibody.tree import MultibodyForces_
applied = MultibodyForces_[AutoDiffXd](ad)
ad.CalcForceElementsContribution(d, applied)
out = ad.CalcInverseDynamics(d, InitializeAutoDiff(a, np.zeros((len(v), len(v)))).flatten(), applied)
value = ExtractGradient(out)
value = np.array(value, dtype=float)
expected = np.array([[0.015814058046638144, -0.34345666149492227, -1.1401111225118077e-09], [0.01304157040034812, 2.546109334074333e-10, 1.2137965420236243e-09], [1.7194991117268798e-09, -8.86111451991755e-10, 0.0]])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 4.4e-13
