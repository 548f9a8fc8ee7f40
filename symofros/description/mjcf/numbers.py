"""Numbers of a compiled MJCF model that are none: MuJoCo lets infinities and NaN of a file pass with a warning."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from symofros.description.mjcf.names import Names
from symofros.errors import Problem

# What the importer computes with: array of the model -> what it is called.
_BODY_FIELDS = {
    "body_pos": "position",
    "body_quat": "orientation",
    "body_ipos": "mass centre",
    "body_iquat": "axes of inertia",
    "body_mass": "mass",
    "body_inertia": "inertia",
    "body_gravcomp": "gravcomp",
}
_JOINT_FIELDS = {
    "jnt_pos": "anchor",
    "jnt_axis": "axis",
    "jnt_stiffness": "stiffness",
    "jnt_stiffnesspoly": "stiffness",
}
_SPEED_FIELDS = {"dof_armature": "armature", "dof_damping": "damping", "dof_dampingpoly": "damping"}
_COORDINATE_FIELDS = {"qpos0": "ref", "qpos_spring": "springref"}
_SITE_FIELDS = {"site_pos": "position", "site_quat": "orientation"}


def infinite_numbers(
    model: Any, bodies: Names, joints: Names, sites: Names, places: Mapping[tuple[str, ...], str], file: str
) -> Iterator[Problem]:
    """Every number that is not finite.

    Args:
        model: An MjModel.
        bodies: Names, like the next two.
        joints: Names of the joints.
        sites: Names of the sites.
        places: Lines of bodies and joints.
        file: File of everything else.
    """
    coordinates = np.searchsorted(model.jnt_qposadr, np.arange(model.nq), side="right") - 1
    for kind, names, owner, arrays in (
        ("body", bodies, np.arange(model.nbody), _BODY_FIELDS),
        ("joint", joints, np.arange(model.njnt), _JOINT_FIELDS),
        ("joint", joints, model.dof_jntid, _SPEED_FIELDS),
        ("joint", joints, coordinates, _COORDINATE_FIELDS),
        ("site", sites, np.arange(model.nsite), _SITE_FIELDS),
    ):
        for array, word in arrays.items():
            rows = np.argwhere(~np.isfinite(getattr(model, array)))[:, 0]
            for i in sorted({int(owner[row]) for row in rows}):
                yield Problem(
                    f"{kind} '{names[i]}': {word} is not a finite number",
                    "NaN or infinity in MuJoCo's model",
                    "every number is finite",
                    "mend the number",
                    places.get((kind, names[i]), file),
                )
    if not np.isfinite(model.opt.gravity).all():
        yield Problem(
            "gravity is not a finite number",
            str(model.opt.gravity),
            "every number is finite",
            "give finite components",
            file,
        )
