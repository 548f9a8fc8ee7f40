"""dynibo: recursive algorithms in Rust, from URDF."""

from __future__ import annotations

from ..interface import Convention, Tree
from .writing.source import Source, SourcePlugin, ways_of
from .writing.urdf import KINDS, UNIT_AXIS, Described, breadth_first, of_files, slots_of, through_reader

_SETUP = '''import numpy as np
import tempfile
from dynibo import Robot, FloatingRobot, BaseState, Pose, Twist
URDF = """{text}"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = {robot}.from_urdf(file.name)
links = [robot.link_id(name) for name in {links}]
'''
_FIXED = "def args(q, *rates): return (q, *rates)"
_FLOATING = """def args(q, *rates):
    twists = [Twist(tuple(x[:3]), tuple(x[3:6])) for x in (*rates, np.zeros(6), np.zeros(6))]
    base = BaseState(Pose(tuple(q[:3]), tuple(q[3:7])), twists[0], twists[1])
    return (base, q[7:], *(x[6:] for x in rates))"""

_LINEAR_FIRST = "np.roll({}.reshape(-1, 6).T, 3, axis=0)"
_TWISTS = "value = [[*t.linear, *t.angular] for t in (robot.{}(*args({}), k) for k in links)]"
WAYS = ways_of(f"""
== mass_matrix | mass_matrix | value = robot.mass_matrix(*args(q)).reshape(len(v), len(v)).T
== gravity | gravity | value = robot.gravity(*args(q))
== coriolis_forces | velocity_product_forces | value = robot.velocity_product_forces(*args(q, v))
== inverse_dynamics | inverse_dynamics | value = robot.inverse_dynamics(*args(q, v, a))
== forward_dynamics | forward_dynamics | value = robot.forward_dynamics(*args(q, v), tau)
== link_jacobians | jacobian | value = [{_LINEAR_FIRST.format("robot.jacobian(*args(q), k)")} for k in links]
== link_jacobian_rates | jacobian_derivative
value = [{_LINEAR_FIRST.format("robot.jacobian_derivative(*args(q, v), k)")} for k in links]
== link_poses | forward_kinematics
value = []
for k in links:
    pose = robot.forward_kinematics(*args(q), k)
    x, y, z, w = pose.rotation_xyzw
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    value.append([*pose.translation, *(np.eye(3) + 2 * w * K + 2 * K @ K).flat])
== link_velocities | forward_velocity_kinematics | {_TWISTS.format("forward_velocity_kinematics", "q, v")}
== link_accelerations | forward_acceleration_kinematics | {_TWISTS.format("forward_acceleration_kinematics", "q, v, a")}
""")
_BASE = "free xyzw, angular and linear before"


def read(tree: Tree, described: Described) -> Source:
    """A file through dynibo's reader of URDF."""
    count, floating = len(described.moving), described.floating
    setup = _SETUP.format(
        text=described.text, robot="FloatingRobot" if floating else "Robot", links=list(described.links)
    )
    return Source(
        (setup, _FLOATING if floating else _FIXED),
        slots_of(tree, described, breadth_first(tree, described), _BASE),
        nq=count + 7 * floating,
        nv=count + 6 * floating,
    )


PLUGIN = SourcePlugin(
    name="dynibo",
    package="dynibo",
    extra="symofros[engine-dynibo]",
    conventions=(
        Convention("order of joints", "breadth first, siblings as the file states them"),
        Convention(
            "floating base", "apart from q: pose with the quaternion's scalar last; angular, then linear, in the world"
        ),
        Convention("spatial vectors", "angular, then linear, along the world's axes at the link's origin"),
        Convention("matrices", "flat, by columns"),
        Convention("armature", "none: URDF has none"),
        Convention("gravity", "9.80665 m/s^2 downwards along z, fixed"),
    ),
    kinds=KINDS | {"free": "FloatingRobot"},
    ways=WAYS,
    write=through_reader(read),
    gravity=(0.0, 0.0, -9.80665),
    formats=("urdf",),
    write_reading=of_files(read),
    statements=(UNIT_AXIS,),
)
