"""Newton: articulations of Warp on the CPU, by its API."""

from __future__ import annotations

from ...interface import SINGLE, Convention, Statement, Tree, Unsupported
from ...models.covering import COVERING
from .. import features, turns
from ..writing.source import Source, SourcePlugin
from ..writing.urdf import has_bare_shape
from . import builders, scenes
from .files import READERS, write_reading
from .files import WAYS as OF_FILES
from .lone import WAYS as OF_LONE
from .lone import write_held, write_wheel
from .model import has_tiny_moments, write
from .ways import IMPORTS, WAYS


def _write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree, or the lone body that is asked for."""
    if tree.asked == COVERING:
        return scenes.write(tree)
    if tree.asked in features.NEWTON:
        return turns.source(*IMPORTS, scalar_last=True)
    if tree.asked == "held distances":
        return write_held(tree)
    return write_wheel(tree) if tree.asked == "wheels" else write(tree)


PLUGIN = SourcePlugin(
    name="newton",
    package="newton",
    extra="symofros[engine-newton]",
    conventions=(
        Convention("precision", "single"),
        Convention("quaternion", "scalar last"),
        Convention("ball joint", "angular velocity along the axes before the joint"),
        Convention("twists and Jacobians of links", "linear velocity of the mass centre, then angular, in the world"),
        Convention("step", "quaternions along their rate at the beginning, then brought to unit length"),
        Convention("targets of joints", "forces at the beginning of SolverFeatherstone's step"),
        Convention("armature", "an argument of the joint; 0.01 unless stated"),
        Convention(
            "free joint", "linear velocity of the mass centre: a speed that depends on the body; not asked here"
        ),
    ),
    kinds={
        "revolute x": "add_joint_revolute",
        "revolute y": "add_joint_revolute",
        "revolute z": "add_joint_revolute",
        "revolute oblique": "add_joint_revolute",
        "revolute with armature": "add_joint_revolute",
        "prismatic": "add_joint_prismatic",
        "prismatic oblique": "add_joint_prismatic",
        "ball": "add_joint_ball",
        "universal": "add_joint_d6",
        "planar": "add_joint_d6",
        "translation": "add_joint_d6",
        "euler xyz": "add_joint_d6",
        "euler zyx": "add_joint_d6",
        "cylindrical": "add_joint_d6",
        "three hinges": "add_joint_d6",
        "two slides and a hinge": "add_joint_d6",
        "translation and euler zyx": "add_joint_d6",
    },
    ways=WAYS | OF_FILES | OF_LONE | scenes.WAYS | builders.WAYS,
    write=_write,
    demands={
        **features.NEWTON,
        "dampers": "damping",
        "springs": "stiffness, rest_q",
        "actuators": "joint_f, target_ke, target_kd",
        "wheels": "SolverXPBD, SolverSemiImplicit, SolverFeatherstone",
        "held distances": "add_joint_distance",
        COVERING: "add_mjcf, SolverMuJoCo",
    },
    formats=tuple(READERS),
    write_reading=write_reading,
    statements=(
        Statement(
            "precondition",
            "stages in other units than metres and kilograms are not supported, with a warning",
            "https://github.com/newton-physics/newton/pull/3219",
            holds=lambda tree, text: text.startswith("#usda"),
            warned="(metersPerUnit|kilogramsPerUnit)",
        ),
        Statement(
            "precondition",
            "coordinates of joints are counted from ref",
            "newton 1.8, newton/_src/utils/import_mjcf.py:2683: Newton joint coordinates use qpos - ref",
            holds=lambda tree, text: " ref=" in text,
        ),
        Statement(
            "precondition",
            "where <inertial> is missing, mass and moments are those of shapes, of the density of ShapeConfig",
            "newton 1.8, newton/_src/sim/builder.py: ShapeConfig.density",
            holds=has_bare_shape,
        ),
        Statement(
            "precondition",
            "joint_damping is none of what SolverXPBD supports",
            "newton 1.8, SolverXPBD: Joint limitations",
            "step_of_wheel|wheel_wrench",
            lambda tree, text: "dampers" in tree.forces,
        ),
        Statement(
            "repairs",
            "inertias that are too small are made larger",
            "newton 1.8, newton/_src/sim/builder.py: ModelBuilder.finalize, its warning",
            holds=has_tiny_moments,
            warned="Inertia validation corrected",
        ),
    ),
    roundoff=SINGLE,
)
