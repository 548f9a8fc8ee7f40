"""What Pinocchio's functions leave in data, what it says of links by joints and frames, and bodies by frames."""

from __future__ import annotations

from ...truth.carried import AFAR
from ..writing.source import Way, ways_of
from .functions import WAYS as FIRST

_EACH = "value = [{of} for j in js]"
_FLAT = "[*{0}.translation, *{0}.rotation.flat]"
_FK = "pin.forwardKinematics(m, d, q, v, a)\n"
_FK_D = "pin.computeForwardKinematicsDerivatives(m, d, q, v, a)\n"
_ID_D = "pin.computeRNEADerivatives(m, d, q, v, a)\n"
_FD_D = "pin.computeABADerivatives(m, d, q, v, tau)\n"
_CRBA = "pin.crba(m, d, q, pin.Convention.WORLD)\n"
_CENTRES = "pin.centerOfMass(m, d, q, v, a)\n"
# Function, what the data keep, the call that fills it, what it is of each link.
_OF_LINKS = (
    ("link_poses", "oMi", _FK, _FLAT.format("d.oMi[j]")),
    ("velocity_local", "v", _FK, "d.v[j].vector"),
    ("acceleration_local", "a", _FK, "d.a[j].vector"),
    ("velocity_world", "ov", _FK_D, "d.ov[j].vector"),
    ("acceleration_world", "oa", _FK_D, "d.oa[j].vector"),
    ("joint_wrenches", "of", _ID_D, "d.oMi[j].actInv(d.of[j]).vector"),
    ("carried_inertias", "oYcrb", _CRBA, "d.oMi[j].actInv(d.oYcrb[j]).matrix()"),
    ("subtree_masses", "mass", _CENTRES, "d.mass[j]"),
    ("subtree_centre_velocities", "vcom", _CENTRES, "d.oMi[j].rotation @ d.vcom[j]"),
    ("subtree_centre_accelerations", "acom", _CENTRES, "d.oMi[j].rotation @ d.acom[j]"),
    ("jacobian_world", "J", "pin.computeJointJacobians(m, d, q)\n", "d.J * m.sparsity_pattern_vector[j]"),
)
_OF_ALL = (
    ("mass_matrix", "M", _CRBA, "d.M"),
    ("mass_matrix_inverse", "Minv", "pin.computeMinverse(m, d, q)\n", "d.Minv"),
    ("forward_dynamics", "ddq", "pin.aba(m, d, q, v, tau)\n", "d.ddq"),
    ("forward_dynamics_dq", "ddq_dq", _FD_D, "d.ddq_dq"),
    ("forward_dynamics_dv", "ddq_dv", _FD_D, "d.ddq_dv"),
    ("inverse_dynamics", "tau", "pin.rnea(m, d, q, v, a)\n", "d.tau"),
    ("inverse_dynamics_dq", "dtau_dq", _ID_D, "d.dtau_dq"),
    ("inverse_dynamics_dv", "dtau_dv", _ID_D, "d.dtau_dv"),
    ("centroidal_matrix", "Ag", "pin.ccrba(m, d, q, v)\n", "d.Ag"),
    ("centroidal_momentum", "hg", "pin.ccrba(m, d, q, v)\n", "d.hg.vector"),
    ("centroidal_inertia", "Ig", "pin.ccrba(m, d, q, v)\n", "d.Ig.matrix()"),
    ("centroidal_matrix_rate", "dAg", "pin.dccrba(m, d, q, v)\n", "d.dAg"),
    (
        "centroidal_momentum_rate",
        "dhg",
        "pin.computeCentroidalMomentumTimeVariation(m, d, q, v, a)\n",
        "d.dhg.vector",
    ),
    ("mass_centre", "com", _CENTRES, "d.com[0]"),
    ("mass_centre_jacobian", "Jcom", "pin.jacobianCenterOfMass(m, d, q)\n", "d.Jcom"),
    ("total_mass", "mass", "pin.computeTotalMass(m, d)\n", "[d.mass[0]]"),
    ("mechanical_energy", "mechanical_energy", "pin.computeMechanicalEnergy(m, d, q, v)\n", "d.mechanical_energy"),
    ("mass_matrix", "U D U^T", f"{_CRBA}pin.cholesky.decompose(m, d)\n", "d.U @ np.diag(d.D) @ d.U.T"),
)
# Bodies that frames carry: those of the links' joints are stated anew, each by a frame on its joint's frame.
_BY_FRAMES = """js
n, joints = pin.Model(m), {}
for j in js:
    n.inertias[j], joints[j] = pin.Inertia.Zero(), n.addJointFrame(j)
    n.addFrame(pin.Frame(f'body {j}', j, joints[j], pin.SE3.Identity(), pin.FrameType.BODY, m.inertias[j]))
e = n.createData()
"""
# What rnea leaves has no placements in the world.
_SUPPORTED = f"{_BY_FRAMES}pin.rnea(n, e, q, v, a)\npin.forwardKinematics(n, e, q, v, a)\n"
# Balls of a radius at the links, and one at a point of the world.
_BALLS = f"""import coal
g, ball = pin.GeometryModel(), coal.Sphere(0.125)
g.addGeometryObject(pin.GeometryObject('afar', 0, 0, pin.SE3(np.eye(3), np.array({list(AFAR)})), ball))
for f in fs:
    at = m.frames[f]
    g.addGeometryObject(pin.GeometryObject(str(f), at.parentJoint, f, at.placement, ball))
    g.addCollisionPair(pin.CollisionPair(0, g.ngeoms - 1))
"""
_PLACED = _BALLS + "{}gd = g.createData()\npin.updateGeometryPlacements(m, d, g, gd, q)\n"
_CLONED = "g = g.clone()\n"
_READ_AGAIN = "kept, g = g, pin.GeometryModel()\ng.loadFromString(kept.saveToString())\n"
_BALL_POSES = f"value = [{_FLAT.format('X')} for X in list(gd.oMg)[1:]]"
_PUSHED = FIRST["applied_wrenches"].code[: FIRST["applied_wrenches"].code.index("value =")] + (
    "given = pin.StdVec_Force(given)\n"
)
# Groups of the joints, one after the other; those of composites joint by joint.
_GROUPS = """L = pin.liegroups
def group(joint):
    if 'Composite' in joint.shortname():
        own = [group(one) for one in joint.extract().joints]
        return sum_of(own)
    known = {(2, 1): L.SO2, (4, 3): L.SE2 if 'Planar' in joint.shortname() else L.SO3, (7, 6): L.SE3}
    return known.get((joint.nq, joint.nv), lambda: L.Rn(joint.nv))()
def sum_of(groups):
    total = groups[0]
    for one in groups[1:]: total = total * one
    return total
G = sum_of([group(one) for one in m.joints[1:] if one.nv])
"""
_TO = f"{_GROUPS}q1 = G.integrate(q, v2)\n"
_BY_GROUPS = {
    "integrate": ("integrate", f"{_GROUPS}value = G.integrate(q, v2)"),
    "difference": ("difference", f"{_TO}value = G.difference(q, q1)"),
    "interpolate": ("interpolate", f"{_TO}value = G.interpolate(q, q1, 0.25)"),
    "integrate_dq": ("dIntegrate_dq", f"{_GROUPS}value = G.dIntegrate_dq(q, v2)"),
    "integrate_dv": ("dIntegrate_dv", f"{_GROUPS}value = G.dIntegrate_dv(q, v2)"),
    "difference_dq": ("dDifference", f"{_TO}value = G.dDifference(q, q1, pin.ARG0)"),
    "difference_dq2": ("dDifference", f"{_TO}value = G.dDifference(q, q1, pin.ARG1)"),
}
# The coordinates of unit length, twice as long.
_DOUBLED = """x = q.copy()
for j in m.joints[1:]:
    if j.nq == j.nv + 1 and 'Composite' not in j.shortname():
        unit = 4 if 'FreeFlyer' in j.shortname() or 'Spherical' in j.shortname() else 2
        x[j.idx_q + j.nq - unit : j.idx_q + j.nq] *= 2
"""
_ROBOT = "r = pin.RobotWrapper(m)\n"
_WRAPPED = {
    "link_poses": ("placement", f"[{_FLAT.format('X')} for X in [r.placement(q, j) for j in js]]"),
    "velocity_local": ("velocity", "[r.velocity(q, v, j).vector for j in js]"),
    "acceleration_local": ("acceleration", "[r.acceleration(q, v, a, j).vector for j in js]"),
    "jacobian_local": ("computeJointJacobian", "[r.computeJointJacobian(q, j) for j in js]"),
}

WAYS = (
    {f"{name}:{kept}": Way(f"data.{kept}", f"{call}js\n{_EACH.format(of=of)}") for name, kept, call, of in _OF_LINKS}
    | {f"{name}:{kept}": Way(f"data.{kept}", f"{call}value = {of}") for name, kept, call, of in _OF_ALL}
    | {f"{name}:liegroups": Way(f"liegroups, {native}", code) for name, (native, code) in _BY_GROUPS.items()}
    | {
        f"{name}:RobotWrapper, {native}": Way(f"RobotWrapper.{native}", f"{_ROBOT}js\nvalue = {of}")
        for name, (native, of) in _WRAPPED.items()
    }
    | ways_of(f"""
== link_poses:liMi | data.liMi
{_FK}js
X = [pin.SE3.Identity()]
for j in range(1, m.njoints): X.append(X[m.parents[j]] * d.liMi[j])
{_EACH.format(of=_FLAT.format("X[j]"))}
== relative_poses | findCommonAncestor, data.liMi
{_FK}js
def path(j, start):
    X = pin.SE3.Identity()
    for k in list(m.supports[j])[start + 1 :]: X = X * d.liMi[k]
    return X
value = []
for j in js:
    _, first, second = pin.findCommonAncestor(m, js[0], j)
    X = path(js[0], first).actInv(path(j, second))
    value.append({_FLAT.format("X")})
== total_mass | computeTotalMass | value = [pin.computeTotalMass(m)]
== coordinates_normalized | normalize | {_DOUBLED}value = pin.normalize(m, x)
== # Counts, then places.
== coordinate_rates:compactTangentMap | compactTangentMap, getTangentToConfigurationSparsitySegment
N, T = np.zeros((m.nq, m.nv)), pin.compactTangentMap(m, q)
count, first = pin.getTangentToConfigurationSparsitySegment(m)
for i in range(m.nq): N[i, first[i] : first[i] + count[i]] = T[i, : count[i]]
value = N @ v
== bias:addFrame | addFrame with inertia | {_BY_FRAMES}value = pin.nonLinearEffects(n, e, q, v)
== mass_matrix:addFrame | addFrame with inertia | {_BY_FRAMES}value = pin.crba(n, e, q)
== carried_inertias:computeSupportedInertiaByFrame | computeSupportedInertiaByFrame
{_SUPPORTED}value = [pin.computeSupportedInertiaByFrame(n, e, joints[j], True).matrix() for j in js]
== joint_wrenches:computeSupportedForceByFrame | computeSupportedForceByFrame
{_SUPPORTED}value = [pin.computeSupportedForceByFrame(n, e, joints[j]).vector for j in js]
== link_poses:updateGeometryPlacements | updateGeometryPlacements | {_PLACED.format("")}{_BALL_POSES}
== link_poses:GeometryModel.clone | GeometryModel.clone | {_PLACED.format(_CLONED)}{_BALL_POSES}
== link_poses:GeometryModel.saveToString | GeometryModel.saveToString, loadFromString
{_PLACED.format(_READ_AGAIN)}{_BALL_POSES}
== shape_poses | buildGeomFromUrdfString, updateGeometryPlacements
g = pin.buildGeomFromUrdfString(m, TEXT, pin.GeometryType.COLLISION)
gd = g.createData()
pin.updateGeometryPlacements(m, d, g, gd, q)
value = [{_FLAT.format("X")} for X in gd.oMg]
== link_distances | computeDistances
{_PLACED.format("")}pin.computeDistances(m, d, g, gd, q)
value = [one.min_distance + 0.25 for one in gd.distanceResults]
== link_distances:computeDistance | computeDistance
{_PLACED.format("")}value = [pin.computeDistance(g, gd, k).min_distance + 0.25 for k in range(len(g.collisionPairs))]
== link_distances:getNearestPoint | computeDistances: getNearestPoint
{_PLACED.format("")}pin.computeDistances(m, d, g, gd, q)
value = [np.linalg.norm(one.getNearestPoint1() - one.getNearestPoint2()) + 0.25
         for one in gd.distanceResults]
== pushed_forces | rnea with external forces | {_PUSHED}value = pin.rnea(m, d, q, v, a, given)
== pushed_accelerations | aba with external forces | {_PUSHED}value = pin.aba(m, d, q, v, tau, given)
== pushed_accelerations:LOCAL | aba with external forces in LOCAL
{_PUSHED}value = pin.aba(m, d, q, v, tau, given, pin.Convention.LOCAL)
""")
    | {
        f"pushed_accelerations_{by}": Way(
            "computeABADerivatives with external forces",
            f"{_PUSHED}value = pin.computeABADerivatives(m, d, q, v, tau, given)[{place}]",
        )
        for place, by in enumerate(("dq", "dv"))
    }
)
