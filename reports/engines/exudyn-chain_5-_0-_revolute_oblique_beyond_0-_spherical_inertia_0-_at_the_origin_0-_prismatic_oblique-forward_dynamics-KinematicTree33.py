# exudyn 1.13.6, chain 5: 0: revolute oblique beyond, 0: spherical inertia, 0: at the origin, 0: prismatic oblique: KinematicTree33.ForwardDynamicsCRB is wrong (M^-1 (tau - h)).
types, parents, masses = ['PrismaticZ', 'RevoluteZ'], [-1, 0], [1.0, 1.0]
rotations = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]
offsets = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
coms = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
inertias = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]
damping = [0.0, 0.0]
stiffness = [0.0, 0.0]
rest = [0.0, 0.0]
gravity, armatures = [0.0, 0.0, -9.81], [0, 0]
links, places = [0, 1], [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
turns = [[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]
import numpy as np
import exudyn as exu
from exudyn import itemInterface as items
container = exu.SystemContainer()
mbs = container.AddSystem()
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
if hasattr(settings, 'solution'): settings.solution.file.write, settings.solution.file.name = False, ''
else: settings.solutionSettings.writeSolutionToFile = False
solver.InitializeSolver(mbs, settings)
def state(q, v=None, a=None):
    now = exu.ConfigurationType.Current
    mbs.systemData.SetODE2Coordinates(q, configuration=now)
    mbs.systemData.SetODE2Coordinates_t(np.zeros(n) if v is None else v, configuration=now)
    mbs.systemData.SetODE2Coordinates_tt(np.zeros(n) if a is None else a, configuration=now)
def forces():
    solver.ComputeODE2RHS(mbs)
    return np.array(solver.GetSystemResidual()[:n])
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
from exudyn import kinematicTree as kt, rigidBodyUtilities as rbu
short = [name[0] + name[-1].lower() for name in types]
turned, moved = [np.array(R) for R in rotations], [np.array(p) for p in offsets]
full = [np.array(J) + m * (np.dot(c, c) * np.eye(3) - np.outer(c, c))
    for J, m, c in zip(inertias, masses, coms)]
python = kt.KinematicTree33(short, turned, moved, full, [np.array(c) for c in coms], masses, parents, gravity)
value = python.ForwardDynamicsCRB(q, v, tau)
import numpy as np
value, expected = np.reshape(value, (2,))[(0,)], -9.81
assert abs(value - expected) <= 9.8e-12, f"{value = }, {expected = }"
