"""pykdl 1.5.1: ChainDynParam.JntToCoriolis, huge before tiny masses.

Result: C v = h - g (nv), C the Coriolis matrix.
Known: none found.
"""

import sys
import numpy as np
sys.path.append('/usr/lib/python3/dist-packages')
import PyKDL as K
chain = K.Chain()
chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), K.Frame(K.Rotation(-0.7123319323378645, 0.3461162623941064, 0.6105626512309265, -0.6485637432245976, 0.007854782407637784, -0.7611198153824579, -0.268231782505918, -0.9381587473874892, 0.21888324639870263), K.Vector(-0.10630118327969384, 0.4338787789537393, 0.22442791313431198))))
chain.addSegment(K.Segment(K.Joint(K.Vector(), K.Vector(0.6666666666666666, -0.3333333333333333, 0.6666666666666666), K.Joint.RotAxis, 1, 0, 0.0)))
chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), K.Frame(), K.RigidBodyInertia(149152914.1632119, K.Vector(-0.043857032141920355, -0.025771785288849852, 0.18949070573878773), K.RotationalInertia(9765779.852048708, 13379296.16581072, 10444614.484902823, 303033.19644972915, 392273.05491541413, 997742.3511289496))))
chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), K.Frame(K.Rotation(-0.8754534028247707, 0.48096200170430886, 0.04750676161468099, -0.46911595340006684, -0.8692818949570108, 0.15581787241999767, 0.11623924358010955, 0.11412510686318217, 0.9866427409328016), K.Vector(-0.29201092170432674, 0.13683653478638447, 0.463003385311357))))
chain.addSegment(K.Segment(K.Joint(K.Vector(), K.Vector(0.6666666666666666, -0.3333333333333333, 0.6666666666666666), K.Joint.RotAxis, 1, 0, 0.0)))
chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), K.Frame(), K.RigidBodyInertia(1.8591085792217488, K.Vector(-0.1283722546678156, 0.0949056874359388, 0.10892053953403968), K.RotationalInertia(0.096539397300591, 0.0944448580153586, 0.10898194686955136, -0.005210450773638082, 0.010080265189673521, -0.010289222977134582))))
chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), K.Frame(K.Rotation(-0.617767856145274, -0.7325495077352964, 0.28589175334459543, 0.10842688413798594, -0.43944219809361934, -0.8917029580139206, 0.7788494634457931, -0.519867072674759, 0.3509013252166157), K.Vector(0.34367642557584577, 0.11571147817626115, -0.4279731263960814))))
chain.addSegment(K.Segment(K.Joint(K.Vector(), K.Vector(0.6666666666666666, -0.3333333333333333, 0.6666666666666666), K.Joint.RotAxis, 1, 0, 0.0)))
chain.addSegment(K.Segment(K.Joint(K.Joint.Fixed), K.Frame(), K.RigidBodyInertia(1.0037841658760902e-08, K.Vector(-0.019364999761275092, 0.09971227485872952, 0.04898263116168783), K.RotationalInertia(8.293886664275547e-10, 1.0777446711564957e-09, 7.448261148841643e-10, 4.463102279402807e-11, 1.7191491387894826e-12, 1.6169041300888298e-11))))
g, n, tips = K.Vector(0.0, 0.0, -9.81), 3, [3, 6, 9]
def jnt(values):
    array = K.JntArray(len(values))
    for k, value in enumerate(values):
        array[k] = value
    return array
def flat(array): return [array[k] for k in range(array.rows())]
def matrix(M): return np.array([[M[i, j] for j in range(M.columns())] for i in range(M.rows())])
def rates(q, v, frame):
    solver = K.ChainJntToJacDotSolver(chain)
    solver.setRepresentation(frame)
    out = []
    for s in tips:
        J = K.Jacobian(n)
        assert solver.JntToJacDot(K.JntArrayVel(jnt(q), jnt(v)), J, s) == 0
        out.append(matrix(J))
    return out
q = np.array([-1.0996201868492035, -1.8914015371177906, -0.45415795612897547])
v = np.array([-0.8020666483629364, 0.9725767279334938, 0.3881357647151733])
tau_ = K.JntArray(n)
assert K.ChainDynParam(chain, g).JntToCoriolis(jnt(q), jnt(v), tau_) == 0
value = flat(tau_)
value = np.array(value, dtype=float)
expected = np.array([-0.1733609425003475, -0.005230103970824989, -1.1204821329841815e-09])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.0e-13
