"""frax: manipulators and humanoids in JAX, from URDF."""

from __future__ import annotations

from dataclasses import replace

from ..interface import Convention, Tree
from .writing.source import Source, SourcePlugin, ways_of
from .writing.urdf import KINDS, UNIT_AXIS, Described, of_files, slots_of, through_reader

_SETUP = '''import os
import numpy as np
import tempfile
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["FRAX_SUPPRESS_WARNINGS"] = "1"
import jax
jax.config.update("jax_enable_x64", True)
from frax import Robot
URDF = """{text}"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering={joints}, floating_base={base})
'''
# Rates of the coordinates, of which a quaternion has half the products with its own.
_RATES = """def rates(q):
    if len(q) == {count}: return np.eye(len(q))
    w, x, y, z = q[3:7]
    N = np.zeros((len(q), len(q) - 1))
    N[:3, :3], N[7:, 6:] = np.eye(3), np.eye(len(q) - 7)
    N[3:7, 3:6] = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
    return N"""


_STANDING = (
    '<link name="world"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
)

WAYS = ways_of("""
== mass_matrix | mass_matrix | value = robot.mass_matrix(q)
== mass_matrix:crba | crba | value = robot.crba(q)
== mass_matrix_inverse | mass_matrix_inverse | value = robot.mass_matrix_inverse(robot.mass_matrix(q))
== bias | nonlinear_bias | value = robot.nonlinear_bias(q, v)
== gravity | gravity_vector | value = robot.gravity_vector(q)
== coriolis_forces | centrifugal_coriolis_vector | value = robot.centrifugal_coriolis_vector(q, v)
== inverse_dynamics | rnea | value = robot.rnea(q, v, a, np.array([0, 0, 9.81, 0, 0, 0]), None)
== forward_dynamics | forward_dynamics | value = robot.forward_dynamics(q, v, tau, None)
== mass_matrix_dq | jacfwd of mass_matrix | value = jax.jacfwd(robot.mass_matrix)(q) @ rates(q)
== inverse_dynamics_dq | jacfwd of rnea
value = jax.jacfwd(lambda x: robot.rnea(x, v, a, np.array([0, 0, 9.81, 0, 0, 0]), None))(q) @ rates(q)
== mass_centre | center_of_mass | value = robot.center_of_mass(q)
== mass_centre_jacobian | center_of_mass_jacobian | value = robot.center_of_mass_jacobian(q)
""")


def read(tree: Tree, described: Described) -> Source:
    """A file through frax's reader of URDF."""
    # A link without inertia breaks its reader, even one that stands still.
    text = described.text.replace('<link name="world"/>', _STANDING)
    count, floating = len(described.moving), described.floating
    setup = _SETUP.format(text=text, joints=list(described.moving), base="'quaternion'" if floating else None)
    slots = slots_of(tree, described, described.moving, "free wxyz, linear before and angular after")
    rates = {"rates": (_RATES.format(count=count),)}
    return Source((setup,), slots, nq=count + 7 * floating, nv=count + 6 * floating, optional=rates)


def _of_file(tree: Tree, described: Described) -> Source:
    """A file that states one thing: each function is compiled anew for it, so that one is asked alone."""
    return replace(read(tree, described), lacks=tuple(name for name in WAYS if name != "mass_matrix"))


PLUGIN = SourcePlugin(
    name="frax",
    package="frax",
    extra="symofros[engine-frax]",
    conventions=(
        Convention("order of joints", "as asked for, otherwise breadth first"),
        Convention("quaternion", "scalar first"),
        Convention("floating base", "linear velocity in the world, angular in the body, as MuJoCo has it"),
        Convention("armature", "none"),
        Convention("gravity", "9.81 m/s^2 downwards along z, fixed"),
        Convention("precision", "single unless JAX is told otherwise"),
    ),
    kinds=KINDS | {"free": "floating_base='quaternion'"},
    ways=WAYS,
    write=through_reader(read),
    gravity=(0.0, 0.0, -9.81),
    formats=("urdf",),
    write_reading=of_files(_of_file),
    statements=(UNIT_AXIS,),
    calls=1,
)
