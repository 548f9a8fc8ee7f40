"""Items of Exudyn between two bodies: connectors, loads, sensors; tools that measure, add and filter."""

from __future__ import annotations

from ...truth.features.connectors import (
    ALONG,
    DAMPING,
    FIRST,
    FORCE,
    FRICTION,
    LOSSES,
    MASSES,
    OFFSET,
    PULL,
    PUSHED,
    REST,
    SECOND,
    STIFFNESS,
    TWISTED,
)
from ...truth.geometry.shapes import BEYOND
from ..writing.source import Way, ways_of

# No files are written; older releases have another name for that.
QUIET = """if hasattr(settings, 'solution'): settings.solution.file.write, settings.solution.file.name = False, ''
else: settings.solutionSettings.writeSolutionToFile = False"""

# Two bodies whose speeds are velocities before and angular velocities along their axes; their points' markers.
_TWO = f"""from exudyn import itemInterface as items
container = exu.SystemContainer()
mbs = container.AddSystem()
bodies = []
# Older releases have other names.
named = ("mass", "inertia")
if named[0] not in items.ObjectRigidBody.__init__.__code__.co_varnames: named = ("physicsMass", "physicsInertia")
numbers = dict(zip(named, (1.0, [1.0] * 3 + [0.0] * 3)))
for place, turned, speeds in ((a, q, np.r_[v, tau]), (tau + {list(BEYOND)}, q2, np.r_[v2, v])):
    r = rbu.RotationMatrix2RotationVector(rbu.EulerParameters2RotationMatrix(turned))
    node = mbs.AddNode(items.NodeRigidBodyRotVecLG(
        referenceCoordinates=[0.0] * 6, initialCoordinates=[*place, *r], initialVelocities=list(speeds)))
    bodies.append(mbs.AddObject(items.ObjectRigidBody(nodeNumber=node, **numbers)))
markers = [mbs.AddMarker(items.MarkerBody{{marker}}(bodyNumber=body, localPosition=place))
    for body, place in zip(bodies, ({list(FIRST)}, {list(SECOND)}))]
"""
# What acts, less the bodies' own gyroscopic forces, which these moments have none of.
_FORCES = f"""
mbs.Assemble()
settings = exu.SimulationSettings()
{QUIET}
settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = False
solver = exu.MainSolverImplicitSecondOrder()
solver.InitializeSolver(mbs, settings)
solver.ComputeODE2RHS(mbs)
value = np.array(solver.GetSystemResidual())"""
_NUMBERS = f"stiffness={STIFFNESS}, damping={DAMPING}"
_SPRING = f"referenceLength={REST}, {_NUMBERS}, force={FORCE}"
_USER = f"""def pull(mbs, t, number, apart, speed, k, d, force): return k * apart + d * speed + force
mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=markers, {_SPRING}, springForceUserFunction=pull))"""
_CARTESIAN = f"markerNumbers=markers, stiffness={list(ALONG)}, damping={list(LOSSES)}, offset={list(OFFSET)}"
_GRAVITY = (
    f"mbs.AddObject(items.ObjectConnectorGravity(markerNumbers=markers, mass0={MASSES[0]}, mass1={MASSES[1]}, "
    f"gravitationalConstant={PULL}, minDistanceRegularization=0.0))"
)


def _acting(text: str, marker: str = "Rigid", count: str = "") -> str:
    return f"{_TWO.format(marker=marker)}{text}{_FORCES}{count}"


def _loads(follows: bool) -> str:
    at = f"markerNumber=markers[0], bodyFixed={follows}"
    return _acting(
        f"mbs.AddLoad(items.LoadForceVector({at}, loadVector={list(PUSHED)}))\n"
        f"mbs.AddLoad(items.LoadTorqueVector({at}, loadVector={list(TWISTED)}))",
        count="[:6]",
    )


_USER_LOADS = _acting(
    f"mbs.AddLoad(items.LoadForceVector(markerNumber=markers[0], loadVector={list(PUSHED)},\n"
    "    loadVectorUserFunction=lambda mbs, t, load: load))\n"
    f"mbs.AddLoad(items.LoadTorqueVector(markerNumber=markers[0], loadVector={list(TWISTED)},\n"
    "    loadVectorUserFunction=lambda mbs, t, load: load))",
    count="[:6]",
)
_MASSES = """from exudyn import itemInterface as items
container = exu.SystemContainer()
mbs = container.AddSystem()
markers = []
for place, speed in ((a[0], v[0]), (v2[0], v[1])):
    node = mbs.AddNode(items.Node1D(referenceCoordinates=[0.0], initialCoordinates=[place], initialVelocities=[speed]))
    mbs.AddObject(items.ObjectMass1D(physicsMass=1.0, nodeNumber=node))
    markers.append(mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)))
"""
_OF_COORDINATES = f"markerNumbers=markers, {_NUMBERS}, offset={REST}"
_COORDINATE_USER = f"""def pull(mbs, t, number, apart, speed, k, d, offset): return k * (apart - offset) + d * speed
mbs.AddObject(items.ObjectConnectorCoordinateSpringDamper({_OF_COORDINATES}, springForceUserFunction=pull))"""
_OUTPUTS = "Position Velocity VelocityLocal RotationMatrix AngularVelocity AngularVelocityLocal"


def _sensing(sensor: str, outputs: str) -> str:
    return _TWO.format(marker="Rigid") + (
        f"sensors = [mbs.AddSensor(items.{sensor}, writeToFile=False, "
        f"outputVariableType=getattr(exu.OutputVariableType, name))) for name in {outputs.split()}]\n"
        "mbs.Assemble()\nvalue = np.concatenate([np.ravel(mbs.GetSensorValues(one)) for one in sensors])"
    )


_OF_BODY = f"SensorBody(bodyNumber=bodies[0], localPosition={list(FIRST)}"
_LIDAR = """from exudyn import itemInterface as items
from exudyn.robotics.utilities import AddLidar
container = exu.SystemContainer()
mbs = container.AddSystem()
R = rbu.EulerParameters2RotationMatrix(q)
ground = mbs.AddObject(items.ObjectGround())
contact = mbs.AddGeneralContact()
contact.SetFrictionPairings(np.eye(1))
contact.SetSearchTreeCellSize([2, 2, 2])
for place in (R[:, 0], R[:, 1]):
    m = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=ground, localPosition=(a + 3 * place).tolist()))
    contact.AddSphereWithMarker(m, radius=1.0, contactStiffness=1e3, contactDamping=0, frictionMaterialIndex=0)
beams = AddLidar(mbs, 0, a.tolist(), maxDistance=10, numberOfSensors=4, angleEnd=np.pi / 2, rotation=R,
    addGraphicsObject=False)
mbs.Assemble()
value = [np.ravel(mbs.GetSensorValues(beam))[0] for beam in beams]"""
WAYS = {
    "connector_spring": Way(
        "ObjectConnectorSpringDamper",
        _acting(f"mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=markers, {_SPRING}))"),
    ),
    "connector_spring:positions": Way(
        "ObjectConnectorSpringDamper, MarkerBodyPosition",
        _acting(f"mbs.AddObject(items.ObjectConnectorSpringDamper(markerNumbers=markers, {_SPRING}))", "Position"),
    ),
    "connector_spring:user function": Way("springForceUserFunction", _acting(_USER)),
    "connector_along_axes": Way(
        "ObjectConnectorCartesianSpringDamper",
        _acting(f"mbs.AddObject(items.ObjectConnectorCartesianSpringDamper({_CARTESIAN}))"),
    ),
} | ways_of(f"""
== connector_gravity | ObjectConnectorGravity | {_acting(_GRAVITY)}
== connector_of_coordinates | ObjectConnectorCoordinateSpringDamper
{_MASSES}mbs.AddObject(items.ObjectConnectorCoordinateSpringDamper({_OF_COORDINATES})){_FORCES}
== connector_of_coordinates:Ext | ObjectConnectorCoordinateSpringDamperExt
{_MASSES}mbs.AddObject(items.ObjectConnectorCoordinateSpringDamperExt({_OF_COORDINATES})){_FORCES}
== connector_of_coordinates:user function | ObjectConnectorCoordinateSpringDamper, springForceUserFunction
{_MASSES}{_COORDINATE_USER}{_FORCES}
== load_before | LoadForceVector, LoadTorqueVector | {_loads(False)}
== load_before:user function | loadVectorUserFunction | {_USER_LOADS}
== load_following | LoadForceVector, LoadTorqueVector, bodyFixed | {_loads(True)}
== body_sensed | SensorBody | {_sensing(_OF_BODY, _OUTPUTS)}
== point_sensed | SensorBody | {_sensing(_OF_BODY, "Position Velocity")}
== point_sensed:SensorMarker | SensorMarker | {_sensing("SensorMarker(markerNumber=markers[0]", "Position Velocity")}
== body_displaced | SensorBody: Displacement | {_sensing(_OF_BODY, "Displacement Rotation")}
== lidar_beams | AddLidar | {_LIDAR}
== friction_stribeck | StribeckFunction
from exudyn.physics import StribeckFunction
value = [StribeckFunction(x, *{list(FRICTION)}) for x in v]
== friction_regularized | RegularizedFriction
from exudyn.physics import RegularizedFriction
d, s, k, _, w = {list(FRICTION)}
value = [RegularizedFriction(x, d, s, w, 2 * w, k) for x in v]
== stress_von_mises | VonMisesStress | from exudyn.physics import VonMisesStress\nvalue = [VonMisesStress([*v, *a])]
== smooth_step | SmoothStep, SmoothStepDerivative
value = [f(x, -0.25, 0.5, -0.5, 1.5) for f in (ut.SmoothStep, ut.SmoothStepDerivative) for x in v]
""")
