"""mink: rotations, placements and their derivatives by its Lie groups; limits of joints of MuJoCo's models."""

from __future__ import annotations

from ...interface import Convention, Tree, Unsupported
from ..writing.numbering import numbered
from ..writing.source import HALF_TURNS, ON_END, Source, SourcePlugin, Way, ways_of
from . import source

_R = "R, Q = mink.SO3(q), mink.SO3(q2)\n"
_X = "X, Y = mink.SE3(np.r_[q, a]), mink.SE3(np.r_[q2, tau])\n"
_V = "V = np.r_[v, v2]\n"


def _flat(of: str) -> str:
    return f"T = ({of}).as_matrix()\nvalue = [*T[:3, 3], *T[:3, :3].flat]"


_MATRIX = "value = ({of}).as_matrix().ravel()"
_ROTATIONS = ways_of(f"""
== rotation_matrix | SO3.as_matrix | {_R}{_MATRIX.format(of="R")}
== rotation_matrix:from_matrix | SO3.from_matrix | {_R}{_MATRIX.format(of="mink.SO3.from_matrix(R.as_matrix())")}
== rotation_composed | SO3.multiply | {_R}{_MATRIX.format(of="R @ Q")}
== rotation_angle | SO3.minus | {_R}value = [np.linalg.norm(Q.minus(R))]
== rotation_logarithm | SO3.log | {_R}value = R.log()
== rotation_exponential | SO3.exp | {_MATRIX.format(of="mink.SO3.exp(v)")}
== rotation_exponential_of_turns | SO3.exp | {_MATRIX.format(of="mink.SO3.exp(16 * v)")}
== rotation_half_turns | SO3.from_matrix
{HALF_TURNS}value = [mink.SO3.from_matrix(H).as_matrix().ravel() for H in half_turns]
== rotation_vector_speeds | SO3.rjac | value = mink.SO3.rjac(tau)
== rotation_vector_speeds:ljac | SO3.ljac | value = mink.SO3.ljac(tau).T
== rotation_vector_rates | SO3.rjacinv | value = mink.SO3.rjacinv(tau)
== rotation_vector_rates_fixed | SO3.ljacinv | value = mink.SO3.ljacinv(v)
== rotation_halfway | SO3.interpolate | {_R}{_MATRIX.format(of="R.interpolate(Q, 0.25)")}
== rotation_of_rpy | SO3.from_rpy_radians | {_MATRIX.format(of="mink.SO3.from_rpy_radians(*v)")}
== rotations_on_end | SO3.as_rpy_radians
{ON_END}value = [mink.SO3.from_rpy_radians(*mink.SO3.from_matrix(H).as_rpy_radians()).as_matrix().ravel() for H in \
on_end]
== rotation_to_rpy | SO3.as_rpy_radians | {_R}value = [*R.as_rpy_radians()]
== rotation_matrix:inverse | SO3.inverse | {_R}value = R.inverse().as_matrix().T.ravel()
""")
_PLACEMENTS = {
    "pose_composed": Way("SE3.multiply", f"{_X}{_flat('X @ Y')}"),
    "pose_unset": Way("SE3.identity", _flat("mink.SE3.identity()")),
    "pose_inverse": Way("SE3.inverse", f"{_X}{_flat('X.inverse()')}"),
    "pose_relative": Way("SE3.inverse", f"{_X}{_flat('X.inverse() @ Y')}"),
    "pose_of_point": Way("SE3.apply", f"{_X}value = X.apply(v)"),
    "pose_logarithm": Way("SE3.log", f"{_X}value = X.log()"),
    "pose_difference": Way("SE3.minus", f"{_X}value = Y.minus(X)"),
    "pose_difference:rminus": Way("SE3.rminus", f"{_X}value = Y.rminus(X)"),
    "pose_composed:rplus": Way("SE3.rplus", f"{_X}{_flat('X.rplus(Y.log())')}"),
    "pose_composed:lplus": Way("SE3.lplus", f"{_X}{_flat('Y.lplus(X.log())')}"),
    "pose_exponential": Way("SE3.exp", f"{_V}{_flat('mink.SE3.exp(V)')}"),
    "pose_halfway": Way("SE3.interpolate", f"{_X}{_flat('X.interpolate(Y, 0.25)')}"),
    "pose_exponential_speeds": Way("SE3.rjac", f"{_V}value = mink.SE3.rjac(V)"),
    "pose_logarithm_rates": Way("SE3.jlog", f"{_X}value = X.jlog()"),
    "pose_logarithm_rates:rjacinv": Way("SE3.rjacinv", f"{_X}value = mink.SE3.rjacinv(X.log())"),
    "twist_transform": Way("SE3.adjoint", f"{_X}value = X.adjoint()"),
}
# What its inequalities let a step of all coordinates reach, from where they are.
_LIMITS = """configuration = mink.Configuration(m, q)
found = mink.ConfigurationLimit(m, gain=1.0, min_distance_from_limits=0.0).compute_qp_inequalities(configuration, 1.0)
value = np.array([[-np.inf, np.inf]] * m.nv)
for row, bound in zip(*found) if found[0] is not None else ():
    k = np.argmax(np.abs(row))
    place = m.jnt_qposadr[m.dof_jntid[k]]
    value[k, int(row[k] > 0)] = configuration.q[place] + bound / row[k]"""
_KINEMATICS = ways_of(f"""
== joint_limits | ConfigurationLimit | {_LIMITS}
== joint_limits_of_some | ConfigurationLimit | {_LIMITS.replace("[-np.inf, np.inf]", "[0.0, 0.0]")}
== link_poses | get_transform_frame_to_world
configuration = mink.Configuration(m, q)
value = []
for name in links:
    T = configuration.get_transform_frame_to_world(name, 'body').as_matrix()
    value.append([*T[:3, 3], *T[:3, :3].flat])
== jacobian_local | get_frame_jacobian
configuration = mink.Configuration(m, q)
value = [configuration.get_frame_jacobian(name, 'body') for name in links]
== integrate | integrate | value = mink.Configuration(m, q).integrate(v2, 1.0)
== mass_matrix | get_inertia_matrix | value = mink.Configuration(m, q).get_inertia_matrix()
""")
_CHARTS = {
    **{
        (kind, form): chart
        for kind, chart in (("revolute", "angle"), ("prismatic", "length"))
        for form in ("", "unbounded")
    },
    ("ball", ""): "quaternion wxyz, body speeds",
    ("free", ""): "free wxyz, linear before and angular after",
}


def write(tree: Tree) -> Source | Unsupported:
    """Text that imports it."""
    return source("import mink") if tree.asked == "turns" else Unsupported("reads MJCF", offered=False)


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has MuJoCo read a file."""
    made = numbered(tree, _CHARTS)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    lines = ("import numpy as np", "import mink, mujoco", f"m = mujoco.MjModel.from_xml_string({text!r})")
    return Source(lines, slots, nq, nv, {"links": (f"links = {[link.name for link in tree.links]!r}",)})


PLUGIN = SourcePlugin(
    name="mink",
    package="mink",
    extra="mink",
    conventions=(
        Convention("quaternion", "w, x, y, z; of a placement before the position"),
        Convention("twists", "linear, then angular, in the frame that moves; rjac and jlog are of these"),
        Convention("models", "of MuJoCo's compiler"),
        Convention("get_frame_jacobian", "along the frame's axes"),
    ),
    kinds={},
    ways=_ROTATIONS | _PLACEMENTS | _KINEMATICS,
    write=write,
    formats=("mjcf",),
    write_reading=write_reading,
    demands={"turns": "SO3, SE3"},
)
