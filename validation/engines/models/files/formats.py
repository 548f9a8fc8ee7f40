"""One tree in each format, so that all readers must agree; and the files that each state one thing of a format."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from ...interface import Joint, Tree, Unsupported
from ...plugins import mujoco
from ...plugins.writing import sdf as sdf_writer
from ...plugins.writing import urdf as urdf_writer
from ..covering import mjcf_files, sdf_files, urdf_files, usd_files
from ..covering.edits import parts
from ..hostile import trees as hostile_trees
from ..kinds import OBLIQUE, link, placed
from . import coupled, drake, mjcf, mjcf_geoms, mjcf_joints, mjcf_lines, mjcf_scopes, sdf, skel, urdf, usd, usd_masses
from .readers import Reading

_WIDE = '<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>'


# MuJoCo writes six digits: files of MJCF whose numbers take more, once they are worked out, are not asked of writers.
# Of mimic joints two are: who fails there ends a process for each function.
_LONG = re.compile(
    "mjcf: .*(euler|angle|axes|zaxis|in full|turned by|box fitted to|geom (box|ell|cyl|cap)|"
    "frames? (around|within)|site (turned|from|by|of)|range.*(left out|degrees))|urdf: mimic( |,)(?!with).*"
)


def _chain() -> Tree:
    draw = np.random.default_rng(12)
    kinds = ("revolute", "prismatic", "revolute", "prismatic")
    return Tree(
        "slides and hinges",
        tuple(link(draw, "abcd"[k], k - 1, placed(draw, Joint(kind, axis=OBLIQUE))) for k, kind in enumerate(kinds)),
    )


def texts(tree: Tree) -> dict[str, str]:
    """The tree in each format that states it."""
    described, document, model = urdf_writer.describe(tree), mujoco.document(tree), sdf_writer.describe(tree)
    made: dict[str, str] = {}
    if not isinstance(described, Unsupported):
        # Not all readers keep a hinge without limits by its angle.
        made["urdf"] = described.text.replace('type="continuous">', f'type="revolute">{_WIDE}')
    if not isinstance(document, Unsupported):
        made["mjcf"] = document[0]
    if not isinstance(model, Unsupported):
        made["sdf"] = model
    return made


def formats() -> dict[str, Reading]:
    """All of them, by name."""
    hostile = hostile_trees()
    made = {}
    for tree in (hostile["six oblique hinges"], hostile["fixed links amid"], _chain()):
        for form, text in texts(tree).items():
            name = f"{form} of {tree.name}"
            made[name] = Reading(form, text, Tree(name, tree.links, tree.gravity))
    urdf_stated, mjcf_stated = urdf_files.files() | urdf.files(), mjcf_files.files() | mjcf.files()
    mjcf_stated |= mjcf_geoms.files() | mjcf_joints.files() | mjcf_lines.files()
    stated = urdf_stated | mjcf_stated
    written = [one for name, one in stated.items() if not any(map(_LONG.search, parts(name)))]
    read = mjcf_scopes.files() | sdf_files.files() | sdf.files() | usd_files.files() | usd.files()
    read |= usd_masses.files() | coupled.files() | drake.files() | skel.files()
    return stated | read | made | dict(map(_written, written))


def _written(one: Reading) -> tuple[str, Reading]:
    """A file that is read, written by the engine and read again."""
    name = f"{one.tree.name}, written"
    return name, replace(one, form=f"{one.form} written", tree=replace(one.tree, name=name))
