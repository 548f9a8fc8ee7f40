"""What DART says by each joint: where it leads from the link before, its Jacobian and rates; by degrees of freedom."""

from __future__ import annotations

from ..writing.source import Way, ways_of

_SET = "s.setPositions(q); s.setVelocities(v); s.setAccelerations(a)\n"
_OWN = "own = [j.getIndexInSkeleton(k) for k in range(j.getNumDofs())]\n"
# Twists are angular, then linear, in the axes of each body; those of the link before are moved to it.
_BY_JOINTS = f"""{_SET}def moved(X, t):
    R, p = X.rotation(), X.translation()
    return np.concatenate([R.T @ t[:3], R.T @ (t[3:] + np.cross(t[:3].T, p).T)])
start, found = (np.zeros(6), np.zeros(6), np.zeros((6, len(v))), np.eye(3), np.zeros(3)), {{}}
for b in links:
    j, parent = b.getParentJoint(), b.getParentBodyNode()
    V, A, J, R, p = found[parent.getName()] if parent else start
    {_OWN}    X, S, rate = j.getRelativeTransform(), np.zeros((6, len(v))), np.zeros((6, len(v)))
    S[:, own], rate[:, own] = j.getRelativeJacobian(), j.getRelativeJacobianTimeDeriv()
    V, step = moved(X, V) + j.getRelativeSpatialVelocity(), j.getRelativeSpatialVelocity()
    turning = np.r_[np.cross(V[:3], step[:3]), np.cross(V[3:], step[:3]) + np.cross(V[:3], step[3:])]
    A = moved(X, A) + turning + rate @ v + S @ a
    found[b.getName()] = (V, A, moved(X, J) + S, R @ X.rotation(), p + R @ X.translation())
V, A, J, R, p = zip(*(found[b.getName()] for b in links))
"""
_FOUND = {
    "link_poses": "[[*at, *turn.flat] for at, turn in zip(p, R)]",
    "velocity_local": "np.roll(V, 3, axis=1)",
    "acceleration_local": "np.roll(A, 3, axis=1)",
    "jacobian_local": "np.roll(J, 3, axis=1)",
}
_EACH = f"for b in links:\n    j = b.getParentJoint()\n    {_OWN}"
_SETTERS = f"{_EACH}    j.setPositions(q[own]); j.setVelocities(v[own])\n"
_DEGREES = "for k in range(s.getNumDofs()): s.getDof(k).setPosition(q[k]); s.getDof(k).setVelocity(v[k])\n"
_WORLD = "W = dart.dynamics.Frame.World()\n"
WAYS = (
    {
        f"{name}:joints": Way("getRelativeTransform, getRelativeJacobian", f"{_BY_JOINTS}value = {of}")
        for name, of in _FOUND.items()
    }
    | {
        f"{name}{way}": Way(native, f"{code}value = s.get{of}()")
        for way, native, code in (("", "joints' setters", _SETTERS), (":DegreeOfFreedom", "DegreeOfFreedom", _DEGREES))
        for name, of in (("coordinates_of_links", "Positions"), ("speeds_of_links", "Velocities"))
    }
    | ways_of(f"""
== bias:joints | joints' setters | {_SETTERS}value = s.getCoriolisAndGravityForces()
== link_poses:DegreeOfFreedom | DegreeOfFreedom.setPosition
{_DEGREES}X = [b.getTransform() for b in links]
value = [[*x.translation(), *x.rotation().flat] for x in X]
== # Beside M, what a step makes of dampers and springs.
== mass_matrix:getAugMassMatrix | getAugMassMatrix | {_SET}s.setTimeStep(0.0)\nvalue = s.getAugMassMatrix()
== link_jacobians:getWorldJacobian | getWorldJacobian
{_SET}value = [np.roll(s.getWorldJacobian(b), 3, axis=0) for b in links]
== link_jacobians:linear and angular | getLinearJacobian, getAngularJacobian
{_SET}{_WORLD}value = [np.r_[s.getLinearJacobian(b, W), s.getAngularJacobian(b, W)] for b in links]
== link_jacobian_rates:linear and angular | getLinearJacobianDeriv, getAngularJacobianDeriv
{_SET}{_WORLD}value = [np.r_[s.getLinearJacobianDeriv(b, W), s.getAngularJacobianDeriv(b, W)] for b in links]
== mass_centre_jacobian:getCOMJacobian | getCOMJacobian | {_SET}{_WORLD}value = s.getCOMJacobian(W)[3:]
== mass_centre_velocity:getCOMSpatialVelocity | getCOMSpatialVelocity
{_SET}{_WORLD}value = s.getCOMSpatialVelocity(W, W)[3:]
""")
)
