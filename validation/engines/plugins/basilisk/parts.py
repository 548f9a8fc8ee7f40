"""Parts of Basilisk's spacecraft: what the messages of wheels say, tanks that share their fuel, sources of gravity."""

from __future__ import annotations

from ...interface import STEP
from ...truth.geometry.poses import AWAY
from ...truth.spaceflight.parts import LENGTH, MU, SOURCE
from ..writing.source import ways_of

_AFTER = round(1e9 * STEP)
_CRAFT = """from Basilisk.architecture import bskLogging, messaging
from Basilisk.simulation import spacecraft
bskLogging.setDefaultLogLevel(bskLogging.BSK_ERROR)
craft = spacecraft.Spacecraft()
craft.hub.mHub, craft.hub.IHubPntBc_B = 100.0, np.eye(3).tolist()
"""
_WHEELS = f"""{_CRAFT}from Basilisk.simulation import reactionWheelStateEffector as effectors
wheels, kept = effectors.ReactionWheelStateEffector(), []
for model, speed in zip(('BalancedWheels', 'JitterSimple', 'BalancedWheels', 'JitterSimple'), (a[0], v[0], a[1], v[1])):
    wheel = effectors.RWConfigPayload()
    wheel.RWModel, wheel.Omega, wheel.mass = getattr(messaging, model), speed, 1.0
    wheel.gsHat_B, wheel.w2Hat0_B, wheel.w3Hat0_B = (np.eye(3)[:, k:k + 1].tolist() for k in range(3))
    wheel.Js, wheel.Jt, wheel.Jg = 0.125, 0.125, 0.125
    wheel.u_max, wheel.u_min, wheel.Omega_max = -1.0, 0.0, -1.0
    wheels.addReactionWheel(wheel)
    kept.append(wheel)
craft.addStateEffector(wheels)
craft.Reset(0), wheels.Reset(0)
craft.UpdateState({_AFTER}), wheels.UpdateState({_AFTER})
said = [one.read() for one in wheels.rwOutMsgs]
value = [*(said[k].theta / {STEP} for k in (1, 3)), *(one.Omega for one in said)]
"""
_TANK = f"""{_CRAFT}from Basilisk.simulation import fuelTank, linearSpringMassDamper
x = np.abs(v) + 0.5
tank, particle, model = fuelTank.FuelTank(), linearSpringMassDamper.LinearSpringMassDamper(), \
fuelTank.FuelTankModelConstantVolume()
model.propMassInit, model.radiusTankInit = x[0], 1.0
tank.setTankModel(model)
tank.setFuelLeakRate(x[2])
particle.k, particle.massInit = 100.0, x[1]
particle.r_PB_B, particle.pHat_B = [[0.0], [0.0], [0.0]], [[1.0], [0.0], [0.0]]
tank.pushFuelSloshParticle(particle)
craft.addStateEffector(tank)
craft.addStateEffector(particle)
craft.Reset(0), tank.Reset(0)
craft.UpdateState({_AFTER})
states = craft.dynManager
value = [states.getStateObject(x).getState()[0][0] for x in (tank.getNameOfMassState(), particle.nameOfMassState)]
"""
_SOURCE = f"""from Basilisk.architecture import bskLogging, messaging
from Basilisk.simulation import NBodyGravity, mujoco, pointMassGravityModel
from Basilisk.utilities import SimulationBaseClass
bskLogging.setDefaultLogLevel(bskLogging.BSK_ERROR)
inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
scene = mujoco.MJScene('<mujoco><worldbody><body name="b"><freejoint/>' + inertial + '</body></worldbody></mujoco>')
scene.extraEoMCall = True
sim = SimulationBaseClass.SimBaseClass()
sim.CreateNewProcess('p').addTask(sim.CreateNewTask('t', {_AFTER}))
sim.AddModelToTask('t', scene)
gravity, model = NBodyGravity.NBodyGravity(), pointMassGravityModel.PointMassGravityModel()
scene.AddModelToDynamicsTask(gravity)
model.muBody = {MU}
place = messaging.SpicePlanetStateMsgPayload()
place.PositionVector = [{LENGTH} * x for x in {SOURCE}]
message = messaging.SpicePlanetStateMsg().write(place)
gravity.addGravitySource('source', model, True).stateInMsg.subscribeTo(message)
target = gravity.addGravityTarget('b', scene.getBody('b'))
sim.InitializeSimulation()
scene.getBody('b').setPosition(({LENGTH} * (v2 + {list(AWAY)})).tolist())
sim.ConfigureStopTime(0)
sim.ExecuteSimulation()
value = target.massFixedForceOutMsg.read().force_S
"""
WAYS = ways_of(f"""
== wheels_among_others | ReactionWheelStateEffector.rwOutMsgs: theta, Omega
{_WHEELS}== sensed_before_a_step | scStateOutMsg: nonConservativeAccelpntB_B
{_CRAFT}craft.Reset(0)
craft.UpdateState(0)
value = 1 + np.array(craft.scStateOutMsg.read().nonConservativeAccelpntB_B)
== tank_shared | FuelTank.pushFuelSloshParticle, setFuelLeakRate
{_TANK}== pull_of_a_source | NBodyGravity: massFixedForceOutMsg
{_SOURCE}""")
