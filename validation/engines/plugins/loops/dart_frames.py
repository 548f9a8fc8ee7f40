"""DART's frames and points of links, wholes of bodies, forces that are applied at bodies."""

from __future__ import annotations

from ...interface import Tree
from ...truth.points import POINT
from ...truth.sensed import WRENCH
from ..writing.source import Way

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
WAYS = {
    "relative_poses": Way(
        "getTransform, withRespectTo",
        f"{_Q}{_SEEN}X = [b.getTransform(A) for b in links]\n"
        "value = [[*x.translation(), *x.rotation().flat] for x in X]",
    ),
    "relative_velocities": Way(
        "getLinearVelocity, getAngularVelocity relative to",
        f"{_QV}{_SEEN}value = [[*b.getLinearVelocity(A, A), *b.getAngularVelocity(A, A)] for b in links]",
    ),
    "relative_accelerations": Way(
        "getLinearAcceleration, getAngularAcceleration relative to",
        f"{_QVA}{_SEEN}value = [[*b.getLinearAcceleration(A, A), *b.getAngularAcceleration(A, A)] for b in links]",
    ),
    "mass_centre_velocity": Way("getCOMLinearVelocity", f"{_QV}value = s.getCOMLinearVelocity()"),
    "mass_centre_acceleration": Way("getCOMLinearAcceleration", f"{_QVA}value = s.getCOMLinearAcceleration()"),
    "mechanical_energy": Way(
        "computeKineticEnergy, computeLagrangian", f"{_QV}value = 2 * s.computeKineticEnergy() - s.computeLagrangian()"
    ),
}

# Of a point of each link.
_POINT = f"x, W = np.array({list(POINT)}), dart.dynamics.Frame.World()\n"
WAYS |= {
    "point_jacobians": Way(
        "getLinearJacobian, of a point", f"{_Q}{_POINT}value = [s.getLinearJacobian(b, x, W) for b in links]"
    ),
    "point_velocities": Way(
        "getLinearVelocity, of a point", f"{_QV}{_POINT}value = [b.getLinearVelocity(x, W, W) for b in links]"
    ),
    "point_accelerations": Way(
        "getLinearAcceleration, of a point", f"{_QVA}{_POINT}value = [b.getLinearAcceleration(x, W, W) for b in links]"
    ),
    "point_velocity_products": Way(
        "getLinearJacobianDeriv, of a point",
        f"{_QV}{_POINT}value = [s.getLinearJacobianDeriv(b, x, W) @ v for b in links]",
    ),
}

_OWN = """own = [
    dart.dynamics.SimpleFrame(links[k], f'o{n}', dart.math.Isometry3(R, r)) for n, (k, R, r) in enumerate(sensed)
]
W = dart.dynamics.Frame.World()
"""
_FLAT = "value = [[*x.translation(), *x.rotation().flat] for x in X]"
WAYS |= {
    name: Way(native, f"{state}{_OWN}{code}")
    for name, native, state, code in (
        ("frame_poses", "SimpleFrame.getTransform", _Q, f"X = [f.getTransform() for f in own]\n{_FLAT}"),
        ("frame_poses_seen", "getTransform, withRespectTo", _Q, f"X = [f.getTransform(own[0]) for f in own]\n{_FLAT}"),
        (
            "frame_velocities",
            "SimpleFrame.getLinearVelocity",
            _QV,
            "value = [[*f.getLinearVelocity(), *f.getAngularVelocity()] for f in own]",
        ),
        (
            "frame_velocities_seen",
            "SimpleFrame.getLinearVelocity relative to",
            _QV,
            "A = own[0]\nvalue = [[*f.getLinearVelocity(A, A), *f.getAngularVelocity(A, A)] for f in own]",
        ),
        (
            "frame_accelerations",
            "SimpleFrame.getLinearAcceleration",
            _QVA,
            "value = [[*f.getLinearAcceleration(), *f.getAngularAcceleration()] for f in own]",
        ),
        ("velocimeters", "getLinearVelocity, inCoordinatesOf", _QV, "value = [f.getLinearVelocity(W, f) for f in own]"),
        ("gyroscopes", "getAngularVelocity, inCoordinatesOf", _QV, "value = [f.getAngularVelocity(W, f) for f in own]"),
        (
            "gyroscopes:getSpatialVelocity",
            "SimpleFrame.getSpatialVelocity",
            _QV,
            "value = [f.getSpatialVelocity()[:3].ravel() for f in own]",
        ),
        (
            "accelerometers",
            "getLinearAcceleration, inCoordinatesOf",
            _QVA,
            "value = [f.getLinearAcceleration(W, f) - f.getTransform().rotation().T @ gravity for f in own]",
        ),
        (
            "angular_accelerations",
            "getAngularAcceleration",
            _QVA,
            "value = [f.getAngularAcceleration() for f in own]",
        ),
    )
}
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


WAYS |= {
    "frame_jacobians": Way(
        "getLinearJacobian of a point, getAngularJacobian",
        f"{_Q}W = dart.dynamics.Frame.World()\n"
        "value = [np.r_[s.getLinearJacobian(links[k], r, W), s.getAngularJacobian(links[k], W)] for k, R, r in sensed]",
    ),
    "frame_jacobians:getJacobian": Way(
        "getJacobian of a point",
        f"{_Q}W = dart.dynamics.Frame.World()\n"
        "value = [np.roll(s.getJacobian(links[k], r, W), 3, axis=0) for k, R, r in sensed]",
    ),
    "frame_velocity_products": Way(
        "getJacobianClassicDeriv of a point",
        f"{_QV}W = dart.dynamics.Frame.World()\n"
        "value = [np.roll(s.getJacobianClassicDeriv(links[k], r, W) @ v, 3) for k, R, r in sensed]",
    ),
    "applied_wrenches": Way("addExtForce, addExtTorque, computeInverseDynamics", f"{_STILL}{_pushed(_LOCAL)}{_DONE}"),
    "applied_wrenches:along the world": Way(
        "addExtForce, addExtTorque along the world", f"{_STILL}{_pushed(_GLOBAL)}{_DONE}"
    ),
    "applied_wrenches:computeForwardDynamics": Way(
        "addExtForce, computeForwardDynamics",
        f"{_STILL}s.setForces(0 * q)\ns.setTimeStep(0.0)\ns.computeForwardDynamics()\nbefore = s.getAccelerations()\n"
        f"{_pushed(_LOCAL)}s.computeForwardDynamics()\n"
        "value = s.getMassMatrix() @ (s.getAccelerations() - before)\ns.clearExternalForces()",
    ),
    "applied_wrenches:getExternalForces": Way(
        "addExtForce, getExternalForces",
        f"{_STILL}{_pushed(_LOCAL)}value = s.getExternalForces()\ns.clearExternalForces()",
    ),
}
# Sums over bodies.
_EACH = "m = np.array([b.getMass() for b in links])\n"
WAYS |= {
    "mass_centre:BodyNode": Way("BodyNode.getCOM", f"{_Q}{_EACH}value = m @ [b.getCOM() for b in links] / s.getMass()"),
    "mass_centre_velocity:BodyNode": Way(
        "BodyNode.getCOMLinearVelocity",
        f"{_QV}{_EACH}value = m @ [b.getCOMLinearVelocity() for b in links] / s.getMass()",
    ),
    "mass_centre_acceleration:BodyNode": Way(
        "BodyNode.getCOMLinearAcceleration",
        f"{_QVA}{_EACH}value = m @ [b.getCOMLinearAcceleration() for b in links] / s.getMass()",
    ),
    "mass_centre_acceleration:getCOMSpatialAcceleration": Way(
        "getCOMLinearJacobian, getCOMLinearJacobianDeriv",
        f"{_QVA}value = s.getCOMLinearJacobian() @ a + s.getCOMLinearJacobianDeriv() @ v",
    ),
    "kinetic_energy:BodyNode": Way(
        "BodyNode.computeKineticEnergy", f"{_QV}value = sum(b.computeKineticEnergy() for b in links)"
    ),
    "centroidal_momentum": Way(
        "BodyNode.getLinearMomentum, getAngularMomentum",
        f"{_QV}L = np.zeros(6)\nfor b in links:\n    R, "
        "p = b.getTransform().rotation(), b.getTransform().translation()\n"
        "    l, h = R @ b.getLinearMomentum(), R @ b.getAngularMomentum()\n"
        "    L += [*l, *(h + np.cross(p - s.getCOM(), l))]\nvalue = L",
    ),
    "subtree_masses": Way(
        "BodyNode.getMass, getChildBodyNode",
        "def below(b):\n"
        "    return b.getMass() + sum(below(b.getChildBodyNode(k)) for k in range(b.getNumChildBodyNodes()))\n"
        "value = [below(b) for b in links]",
    ),
    "inverse_dynamics_acted": Way(
        "computeInverseDynamics with dampers and springs",
        f"{_QVA}s.setTimeStep(0.0)\ns.computeInverseDynamics(False, True, True)\nvalue = s.getForces()",
    ),
}
