# pinocchio 4.1.0, mimic revolute: buildReducedModel with geometry, crba is wrong (M).
# at speeds times 100, after another state on the same model: right by itself.
import numpy as np
import pinocchio as pin
m = pin.Model()
j0 = m.addJoint(0, pin.JointModelRX(), pin.SE3(np.array([[-0.5267235670097701, -0.5575416169730901, 0.6416460311570051], [0.6063142560067553, -0.7754788783432417, -0.17611227159537382], [0.5957728652091158, 0.29627665211173815, 0.7465084316295302]]), np.array([-0.4666258726979181, 0.36420099929086047, -0.027794441649239943])), 'a')
m.appendBodyToJoint(j0, pin.Inertia(1.7308853936062052, np.array([0.16458024338002247, -0.12632740143802212, 0.09687718128207284]), np.array([[0.15495155355308624, 0.00012881741192120964, 0.0018678479962345642], [0.00012881741192120964, 0.14902243615443542, -0.015601379795195892], [0.0018678479962345642, -0.015601379795195892, 0.14126893501522353]])), pin.SE3.Identity())
s1 = pin.JointModelRY()
s1.setIndexes(j0, m.idx_qs[j0], m.idx_vs[j0])
j1 = m.addJoint(j0, pin.JointModelMimic(s1, 1.5, 0.25), pin.SE3(np.array([[-0.09624783513165268, 0.9953440888237056, 0.005147725340132485], [-0.8281629242751368, -0.07721064647927921, -0.5551438434552848], [-0.5521616838286809, -0.057694548390285594, 0.8317384288329576]]), np.array([-0.11088514209722855, -0.4362358235035104, -0.3359605015258662])), 'b')
m.appendBodyToJoint(j1, pin.Inertia(1.2345586688270958, np.array([-0.12351055522657339, -0.05474183170346564, -0.0687013504901299]), np.array([[0.13349253681611525, -0.015084174080295353, -0.001681908851122453], [-0.015084174080295353, 0.14619719354235916, 0.01669103038317761], [-0.001681908851122453, 0.01669103038317761, 0.1330986226923458]])), pin.SE3.Identity())
j2 = m.addJoint(j1, pin.JointModelRevoluteUnaligned(np.array([0.6666666666666666, -0.3333333333333333, 0.6666666666666666])), pin.SE3(np.array([[-0.40088091630986405, -0.7258097904422055, -0.5590121993631315], [0.7555749882149864, -0.6070031658066635, 0.24627950358203074], [-0.5180742496230506, -0.32364688288152876, 0.7917397091712547]]), np.array([0.2326616016010714, 0.29302094617516694, -0.2375809942696474])), 'c')
m.appendBodyToJoint(j2, pin.Inertia(1.7787015466019962, np.array([0.04735634757318227, -0.13987355233828136, -0.08834916462429843]), np.array([[0.10690772690898302, 0.011899982163312856, 0.005962645792104046], [0.011899982163312856, 0.09531931647730724, -0.0233864167166434], [0.005962645792104046, -0.0233864167166434, 0.11413419459505454]])), pin.SE3.Identity())
fs = [m.addFrame(pin.Frame('f0', j0, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f1', j1, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME)), m.addFrame(pin.Frame('f2', j2, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))]
js = [j0, j1, j2]
d = m.createData()
q = np.array([0.0, 0.0])
if globals().get('made_by') != 'buildReducedModel with geometry':
    made_by = 'buildReducedModel with geometry'
    import coal
    g = pin.GeometryModel()
    g.addGeometryObject(pin.GeometryObject('ball', 0, 0, pin.SE3.Identity(), coal.Sphere(0.25)))
    m, g = pin.buildReducedModel(m, g, [], pin.neutral(m))
    d = m.createData()
value = pin.crba(m, d, q)
q = np.array([-1.0996201868492035, -1.8914015371177906])
if globals().get('made_by') != 'buildReducedModel with geometry':
    made_by = 'buildReducedModel with geometry'
    import coal
    g = pin.GeometryModel()
    g.addGeometryObject(pin.GeometryObject('ball', 0, 0, pin.SE3.Identity(), coal.Sphere(0.25)))
    m, g = pin.buildReducedModel(m, g, [], pin.neutral(m))
    d = m.createData()
value = pin.crba(m, d, q)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(0, 1)], 0.0585442953391754
assert abs(value - expected) <= 5.9e-12, f"{value = }, {expected = }"
