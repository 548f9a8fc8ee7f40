"""DART's frames and points of links, wholes of bodies, forces that are applied at bodies."""

from __future__ import annotations

from ...interface import Tree
from ...truth.points import POINT
from ...truth.sensed import WRENCH
from ..writing.source import ways_of

_Q = "s.setPositions(q)\n"
_QV = f"{_Q}s.setVelocities(v)\n"
_QVA = f"{_QV}s.setAccelerations(a)\n"


def sensed(tree: Tree) -> dict[str, tuple[str, ...]]:
    """Statements that list the frames at which sensors stand: link, rotation and place in it."""
    if not tree.sensors:
        return {}
    names = [link.name for link in tree.links]
    frames = ", ".join(f"({names.index(end.link)}, np.array({end.R!r}), np.array({end.p!r}))" for end in tree.sensors)
    return {"sensed": (f"sensed, gravity = [{frames}], np.array({list(tree.gravity)!r})",)}


# As the first link sees them, along its axes.
_SEEN = "A = links[0]\n"
WAYS = ways_of(f"""
== relative_poses | getTransform, withRespectTo
{_Q}{_SEEN}X = [b.getTransform(A) for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
== relative_velocities | getLinearVelocity, getAngularVelocity relative to
{_QV}{_SEEN}value = [[*b.getLinearVelocity(A, A), *b.getAngularVelocity(A, A)] for b in links]
== relative_accelerations | getLinearAcceleration, getAngularAcceleration relative to
{_QVA}{_SEEN}value = [[*b.getLinearAcceleration(A, A), *b.getAngularAcceleration(A, A)] for b in links]
== mass_centre_velocity | getCOMLinearVelocity | {_QV}value = s.getCOMLinearVelocity()
== mass_centre_acceleration | getCOMLinearAcceleration | {_QVA}value = s.getCOMLinearAcceleration()
== mechanical_energy | computeKineticEnergy, computeLagrangian
{_QV}value = 2 * s.computeKineticEnergy() - s.computeLagrangian()
""")

# Of a point of each link.
_POINT = f"x, W = np.array({list(POINT)}), dart.dynamics.Frame.World()\n"
WAYS |= ways_of(f"""
== point_jacobians | getLinearJacobian, of a point | {_Q}{_POINT}value = [s.getLinearJacobian(b, x, W) for b in links]
== point_velocities | getLinearVelocity, of a point | {_QV}{_POINT}value = [b.getLinearVelocity(x, W, W) for b in links]
== point_accelerations | getLinearAcceleration, of a point
{_QVA}{_POINT}value = [b.getLinearAcceleration(x, W, W) for b in links]
== point_velocity_products | getLinearJacobianDeriv, of a point
{_QV}{_POINT}value = [s.getLinearJacobianDeriv(b, x, W) @ v for b in links]
""")

_OWN = """own = [
    dart.dynamics.SimpleFrame(links[k], f'o{n}', dart.math.Isometry3(R, r)) for n, (k, R, r) in enumerate(sensed)
]
W = dart.dynamics.Frame.World()
"""
_FLAT = "value = [[*x.translation(), *x.rotation().flat] for x in X]"
WAYS |= ways_of(f"""
== frame_poses | SimpleFrame.getTransform | {_Q}{_OWN}X = [f.getTransform() for f in own]\n{_FLAT}
== frame_poses_seen | getTransform, withRespectTo | {_Q}{_OWN}X = [f.getTransform(own[0]) for f in own]\n{_FLAT}
== frame_velocities | SimpleFrame.getLinearVelocity
{_QV}{_OWN}value = [[*f.getLinearVelocity(), *f.getAngularVelocity()] for f in own]
== frame_velocities_seen | SimpleFrame.getLinearVelocity relative to
{_QV}{_OWN}A = own[0]
value = [[*f.getLinearVelocity(A, A), *f.getAngularVelocity(A, A)] for f in own]
== frame_accelerations | SimpleFrame.getLinearAcceleration
{_QVA}{_OWN}value = [[*f.getLinearAcceleration(), *f.getAngularAcceleration()] for f in own]
== velocimeters | getLinearVelocity, inCoordinatesOf | {_QV}{_OWN}value = [f.getLinearVelocity(W, f) for f in own]
== gyroscopes | getAngularVelocity, inCoordinatesOf | {_QV}{_OWN}value = [f.getAngularVelocity(W, f) for f in own]
== gyroscopes:getSpatialVelocity | SimpleFrame.getSpatialVelocity
{_QV}{_OWN}value = [f.getSpatialVelocity()[:3].ravel() for f in own]
== accelerometers | getLinearAcceleration, inCoordinatesOf
{_QVA}{_OWN}value = [f.getLinearAcceleration(W, f) - f.getTransform().rotation().T @ gravity for f in own]
== angular_accelerations | getAngularAcceleration | {_QVA}{_OWN}value = [f.getAngularAcceleration() for f in own]
""")
_PUSH, _TURN = f"np.array({list(WRENCH[:3])})", f"np.array({list(WRENCH[3:])})"
_STILL = f"{_Q}s.setVelocities(0 * q)\ns.setAccelerations(0 * q)\ns.clearExternalForces()\n"
_DONE = "s.computeInverseDynamics(True)\nvalue = s.getGravityForces() - s.getForces()\ns.clearExternalForces()"
_LOCAL = """for k, R, r in sensed:
    links[k].addExtForce(R @ PUSH, r, True, True)
    links[k].addExtTorque(R @ TURN, True)
"""
_GLOBAL = """for k, R, r in sensed:
    A = links[k].getTransform().rotation()
    links[k].addExtForce(A @ R @ PUSH, A @ r + links[k].getTransform().translation(), False, False)
    links[k].addExtTorque(A @ R @ TURN, False)
"""


def _pushed(code: str) -> str:
    return code.replace("PUSH", _PUSH).replace("TURN", _TURN)


WAYS |= ways_of(f"""
== frame_jacobians | getLinearJacobian of a point, getAngularJacobian
{_Q}W = dart.dynamics.Frame.World()
value = [np.r_[s.getLinearJacobian(links[k], r, W), s.getAngularJacobian(links[k], W)] for k, R, r in sensed]
== frame_jacobians:getJacobian | getJacobian of a point
{_Q}W = dart.dynamics.Frame.World()
value = [np.roll(s.getJacobian(links[k], r, W), 3, axis=0) for k, R, r in sensed]
== frame_velocity_products | getJacobianClassicDeriv of a point
{_QV}W = dart.dynamics.Frame.World()
value = [np.roll(s.getJacobianClassicDeriv(links[k], r, W) @ v, 3) for k, R, r in sensed]
== applied_wrenches | addExtForce, addExtTorque, computeInverseDynamics | {_STILL}{_pushed(_LOCAL)}{_DONE}
== applied_wrenches:along the world | addExtForce, addExtTorque along the world | {_STILL}{_pushed(_GLOBAL)}{_DONE}
== applied_wrenches:computeForwardDynamics | addExtForce, computeForwardDynamics
{_STILL}s.setForces(0 * q)
s.setTimeStep(0.0)
s.computeForwardDynamics()
before = s.getAccelerations()
{_pushed(_LOCAL)}s.computeForwardDynamics()
value = s.getMassMatrix() @ (s.getAccelerations() - before)
s.clearExternalForces()
== applied_wrenches:getExternalForces | addExtForce, getExternalForces
{_STILL}{_pushed(_LOCAL)}value = s.getExternalForces()
s.clearExternalForces()
""")
# Sums over bodies.
_EACH = "m = np.array([b.getMass() for b in links])\n"
WAYS |= ways_of(f"""
== mass_centre:BodyNode | BodyNode.getCOM | {_Q}{_EACH}value = m @ [b.getCOM() for b in links] / s.getMass()
== mass_centre_velocity:BodyNode | BodyNode.getCOMLinearVelocity
{_QV}{_EACH}value = m @ [b.getCOMLinearVelocity() for b in links] / s.getMass()
== mass_centre_acceleration:BodyNode | BodyNode.getCOMLinearAcceleration
{_QVA}{_EACH}value = m @ [b.getCOMLinearAcceleration() for b in links] / s.getMass()
== mass_centre_acceleration:getCOMSpatialAcceleration | getCOMLinearJacobian, getCOMLinearJacobianDeriv
{_QVA}value = s.getCOMLinearJacobian() @ a + s.getCOMLinearJacobianDeriv() @ v
== kinetic_energy:BodyNode | BodyNode.computeKineticEnergy | {_QV}value = sum(b.computeKineticEnergy() for b in links)
== centroidal_momentum | BodyNode.getLinearMomentum, getAngularMomentum
{_QV}L = np.zeros(6)
for b in links:
    R, p = b.getTransform().rotation(), b.getTransform().translation()
    l, h = R @ b.getLinearMomentum(), R @ b.getAngularMomentum()
    L += [*l, *(h + np.cross(p - s.getCOM(), l))]
value = L
== subtree_masses | BodyNode.getMass, getChildBodyNode
def below(b):
    return b.getMass() + sum(below(b.getChildBodyNode(k)) for k in range(b.getNumChildBodyNodes()))
value = [below(b) for b in links]
== inverse_dynamics_acted | computeInverseDynamics with dampers and springs
{_QVA}s.setTimeStep(0.0)
s.computeInverseDynamics(False, True, True)
value = s.getForces()
""")
