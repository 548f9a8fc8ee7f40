"""adam: floating-base dynamics by CasADi's expressions, from URDF."""

from __future__ import annotations

from ..interface import Convention, Tree
from .writing.source import Source, SourcePlugin, ways_of
from .writing.urdf import KINDS, UNIT_AXIS, Described, of_files, slots_of, through_reader

_SETUP = """import casadi as ca
import numpy as np
from adam.casadi import KinDynComputations
robot = KinDynComputations({text!r}, {joints}, gravity=np.array({gravity}))"""
_PLACE = (
    "def place(q):",
    "    x, y, z, w = q[3:7]",
    "    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])",
    "    H = np.eye(4)",
    "    H[:3, 3], H[:3, :3] = q[:3], np.eye(3) + 2 * w * K + 2 * K @ K",
    "    return H, q[7:]",
)
# The base is always there: where it stands still, its rows and columns are left out.
_FIXED = {"*place(q)": "np.eye(4), q", "*move(v)": "np.zeros(6), v", "cut": "6"}
_FLOATING = {"*move(v)": "v[:6], v[6:]", "[cut:, cut:]": "", "[:, :, cut:]": "", "[:, cut:]": "", "[cut:]": ""}


def _term(method: str, inputs: str, rows: str = "[cut:]") -> str:
    return f"value = np.array(robot.{method}()({inputs})).squeeze(-1){rows}"


WAYS = ways_of(f"""
== mass_matrix | mass_matrix | value = np.array(robot.mass_matrix_fun()(*place(q)))[cut:, cut:]
== mass_matrix_dq | jacobian of mass_matrix
s = ca.SX.sym("s", len(q))
M = ca.SX(robot.mass_matrix(np.eye(4), s))[6:, 6:]
value = np.array(ca.Function("e", [s], [ca.densify(ca.jacobian(ca.vec(M.T), s))])(q)).reshape(*[len(q)] * 3)
== bias | bias_force | {_term("bias_force_fun", "*place(q), *move(v)")}
== gravity | gravity_term | {_term("gravity_term_fun", "*place(q)")}
== coriolis_forces | coriolis_term | {_term("coriolis_term_fun", "*place(q), *move(v)")}
== forward_dynamics | aba
value = np.array(ca.evalf(robot.aba(*place(q), *move(v), tau[6:], {{links[0]: tau[:6]}}))).squeeze(-1)
== link_poses | forward_kinematics
value = []
for name in links:
    H = np.array(robot.forward_kinematics_fun(name)(*place(q)))
    value.append([*H[:3, 3], *H[:3, :3].flat])
== link_jacobians | jacobian | value = np.array([robot.jacobian_fun(name)(*place(q)) for name in links])[:, :, cut:]
== link_jacobian_rates | jacobian_dot
value = np.array([robot.jacobian_dot_fun(name)(*place(q), *move(v)) for name in links])[:, :, cut:]
== link_velocity_products | jacobian_dot
value = [np.array(robot.jacobian_dot_fun(name)(*place(q), *move(v)))[:, cut:] @ v for name in links]
== mass_centre | CoM_position | {_term("CoM_position_fun", "*place(q)", "")}
== mass_centre_jacobian | CoM_jacobian | value = np.array(robot.CoM_jacobian_fun()(*place(q)))[:, cut:]
== centroidal_matrix | centroidal_momentum_matrix
value = np.array(robot.centroidal_momentum_matrix_fun()(*place(q)))[:, cut:]
""")
_BASE = "free xyzw, linear and angular before"


def read(tree: Tree, described: Described) -> Source:
    """A file through adam's reader of URDF."""
    count, floating = len(described.moving), described.floating
    setup = _SETUP.format(text=described.text, joints=list(described.moving), gravity=[*tree.gravity, 0.0, 0.0, 0.0])
    # Its forward dynamics let the base float.
    return Source(
        tuple(setup.split("\n")),
        slots_of(tree, described, described.moving, _BASE),
        nq=count + 7 * floating,
        nv=count + 6 * floating,
        optional={"links": (f"links = {list(described.links)}",), "place": _PLACE},
        lacks=("mass_matrix_dq",) if floating else ("forward_dynamics",),
        spelling=_FLOATING if floating else _FIXED,
    )


PLUGIN = SourcePlugin(
    name="adam",
    package="adam-robotics",
    extra="symofros[engine-adam]",
    conventions=(
        Convention("order of joints", "as asked for when the model is made"),
        Convention(
            "floating base", "always there: pose apart from q; linear and angular in the world (mixed representation)"
        ),
        Convention("spatial vectors", "linear, then angular"),
        Convention("armature", "none"),
        Convention("gravity", "9.80665 m/s^2 downwards along z unless an argument says otherwise"),
    ),
    kinds=KINDS | {"free": "floating base"},
    ways=WAYS,
    write=through_reader(read),
    formats=("urdf",),
    write_reading=of_files(read),
    statements=(UNIT_AXIS,),
    calls=1,
)
