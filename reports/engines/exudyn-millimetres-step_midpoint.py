# exudyn 1.13.6, millimetres: SolveDynamic, ExplicitMidpoint is imprecise (q+, v+ (nq + nv) after a step: the midpoint rule, in coordinates).
types, parents, masses = ['RevoluteX', 'RevoluteZ'], [-1, 0], [1.0, 1.2036421551830162e-09]
rotations = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[0.4012788364501045, -0.6355517103683882, -0.6595826853890776], [0.8314163761708104, -0.049428392185995956, 0.5534470557161769], [-0.38434633451126843, -0.7704744366257223, 0.5085735321996498]]]
offsets = [[0.0, 0.0, 0.0], [0.0001560235050976978, 9.882011712036254e-05, 0.0003782126711535207]]
coms = [[0.0, 0.0, 0.0], [1.4921335469826651e-05, -0.00010541705165918286, -0.000167098287161996]]
inertias = [[[1.5387418968542935e-16, -1.040257262437649e-18, -7.580033460432243e-18], [-1.040257262437649e-18, 1.570376058065325e-16, 7.857115752477788e-18], [-7.580033460432243e-18, 7.857115752477788e-18, 1.848297784889552e-16]], [[1.6573611200259876e-16, -1.334921291477397e-18, -1.8328684789252998e-18], [-1.3349212914773988e-18, 1.2683937839493649e-16, -1.399496413437545e-17], [-1.8328684789252994e-18, -1.3994964134375453e-17, 1.3145036371461698e-16]]]
damping = [0.0, 0.0]
stiffness = [0.0, 0.0]
rest = [0.0, 0.0]
gravity, armatures = [0.0, 0.0, 0.0], [0, 0]
links, places = [0, 1], [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
turns = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[0.7071067811865476, 0.2357022603955159, 0.6666666666666667], [0.0, 0.9428090415820636, -0.33333333333333337], [-0.7071067811865476, 0.2357022603955159, 0.6666666666666667]]]
import numpy as np
import exudyn as exu
from exudyn import itemInterface as items
mbs = exu.SystemContainer().AddSystem()
n = len(types)
still = [0.0] * n
node = mbs.AddNode(items.NodeGenericODE2(referenceCoordinates=still, initialCoordinates=still,
    initialCoordinates_t=still, numberOfODE2Coordinates=n))
tree = mbs.AddObject(items.ObjectKinematicTree(nodeNumber=node, gravity=gravity,
    jointTypes=[getattr(exu.JointType, name) for name in types], linkParents=parents,
    jointTransformations=exu.Matrix3DList([np.array(R) for R in rotations]), jointOffsets=exu.Vector3DList(offsets),
    linkInertiasCOM=exu.Matrix3DList([np.array(J) for J in inertias]), linkCOMs=exu.Vector3DList(coms),
    linkMasses=masses, jointPControlVector=stiffness, jointPositionOffsetVector=rest, jointDControlVector=damping,
    jointVelocityOffsetVector=still))
if any(armatures):
    mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(armatures)))
def sensor(link, place, name):
    kind = getattr(exu.OutputVariableType, name)
    return mbs.AddSensor(items.SensorKinematicTree(objectNumber=tree, linkNumber=link, localPosition=place,
        outputVariableType=kind, writeToFile=False))
names = ("Position", "RotationMatrix", "Velocity", "AngularVelocity", "Acceleration", "AngularAcceleration")
# Of the world there are none.
sensors = [[sensor(link, place, name) for name in names if link >= 0] for link, place in zip(links, places)]
def read(k): return [[*mbs.GetSensorValues(s[k]), *mbs.GetSensorValues(s[k + 1])] if s else [0.0] * 6 for s in sensors]
mbs.Assemble()
solver = exu.MainSolverImplicitSecondOrder()
settings = exu.SimulationSettings()
settings.solution.file.write, settings.solution.file.name = False, ""
solver.InitializeSolver(mbs, settings)
def state(q, v=None, a=None):
    now = exu.ConfigurationType.Current
    mbs.systemData.SetODE2Coordinates(q, configuration=now)
    mbs.systemData.SetODE2Coordinates_t(np.zeros(n) if v is None else v, configuration=now)
    mbs.systemData.SetODE2Coordinates_tt(np.zeros(n) if a is None else a, configuration=now)
def forces():
    solver.ComputeODE2RHS(mbs)
    return np.array(solver.GetSystemResidual()[:n])
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([0.0, 0.0])
tau = np.array([-0.39625206603607555, -0.8533158648967247])
initial, s = exu.ConfigurationType.Initial, mbs.systemData
mbs.SetObjectParameter(tree, "jointForceVector", tau.tolist())
s.SetODE2Coordinates(q, configuration=initial)
s.SetODE2Coordinates_t(v, configuration=initial)
settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 1, 0.015625
settings.timeIntegration.verboseMode, settings.timeIntegration.adaptiveStep = 0, False
mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.ExplicitMidpoint)
mbs.SetObjectParameter(tree, "jointForceVector", still)
value = np.r_[s.GetODE2Coordinates(), s.GetODE2Coordinates_t()]
import numpy as np
value, expected = np.reshape(value, (4,))[(3,)], 2.0154475248553442e+24
assert abs(value - expected) <= 1.4e+13, f"{value = }, {expected = }"
