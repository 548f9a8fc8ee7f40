"""MuJoCo's compiled model -> neutral tree: bodies in MuJoCo's order, remarks on what is left out, numbers refused."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.description.forces import Load
from symofros.description.frames import Frame
from symofros.description.imported.geometry import Exact, rotation_of
from symofros.description.imported.options import ImportOptions
from symofros.description.imported.tree import ImportedBody, ImportedTree
from symofros.description.joints.joint import WORLD
from symofros.description.mjcf.actuators import ActuatorReader
from symofros.description.mjcf.equalities import EqualityReader
from symofros.description.mjcf.joints import FREE, Chain, JointReader
from symofros.description.mjcf.meshes import DrawnMesh
from symofros.description.mjcf.names import Names
from symofros.description.mjcf.visuals import Texture, visuals_of
from symofros.description.remarks import Remarks
from symofros.description.system import Inertia
from symofros.errors import DescriptionError, Problem

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


_NO_CONTACTS, _NO_GRAVITY = 1 << 0 | 1 << 4, 1 << 7  # mjDSBL_CONSTRAINT and _CONTACT, mjDSBL_GRAVITY


@dataclass(frozen=True)
class Stated:
    """Entries that a compiled model does not hold.

    Attributes:
        name: Name of the model.
        file: Main file of the model.
        places: Lines of bodies, joints and constraints, as in System.origin.
        drawn: Meshes that shapes without mass stand for.
        by_name: Meshes that MuJoCo reads, by their names.
        textures: Textures of materials, by the materials' names.
    """

    name: str
    file: str
    places: Mapping[tuple[str, ...], str]
    drawn: Sequence[DrawnMesh]
    by_name: Mapping[str, DrawnMesh]
    textures: Mapping[str, Texture]


class Importer:
    """Turns one compiled model into a neutral tree.

    Args:
        model: An MjModel.
        stated: Entries of the document that the compiled model does not keep.
        remarks: Remarks on what is ignored or changed.
        options: How it is read.
    """

    def __init__(self, model: Any, stated: Stated, remarks: Remarks, options: ImportOptions) -> None:
        self.model = model
        self.stated = stated
        self.remarks = remarks
        self.options, self.exact = options, Exact(options.snap_tol)
        self.bodies = Names("body", [model.body(i).name for i in range(model.nbody)])
        self.joints = Names("joint", [model.joint(i).name for i in range(model.njnt)])
        self.sites = Names("site", [model.site(i).name for i in range(model.nsite)])
        self.actuators = ActuatorReader(model, self.joints, self.sites, remarks)
        self.reader = JointReader(model, self.joints, self.actuators.efforts, remarks, self.exact)
        off = model.opt.disableflags & _NO_GRAVITY
        self.gravity = np.zeros(3) if off else np.array(model.opt.gravity)

    def tree(self) -> ImportedTree:
        """The bodies of the model.

        Raises:
            DescriptionError: Numbers of the model are not finite.
        """
        places, file = self.stated.places, self.stated.file
        problems = [*infinite_numbers(self.model, self.bodies, self.joints, self.sites, places, file)]
        if problems:
            raise DescriptionError(problems)
        equalities = EqualityReader(self.model, self.bodies, self.joints, self.sites, self.remarks, self.exact)
        frames = self._frames()
        for i, more in equalities.frames.items():
            frames.setdefault(i, []).extend(more)
        bodies = [self._body(i) for i in range(1, self.model.nbody)]
        self._remark_ignored()
        return ImportedTree(
            self.stated.name,
            self.options,
            file,
            limits_act=True,
            noun="body",
            remarks=self.remarks,
            exact=self.exact,
            bodies=bodies,
            frames={self.bodies[i] if i else WORLD: own for i, own in frames.items()},
            gravity=self.exact.vector(self.gravity),
            inputs=tuple(self.actuators.inputs),
            constraints=equalities.constraints,
            origin={("system",): file, **places},
            visuals=visuals_of(
                self.model,
                self.bodies.__getitem__,
                self.stated.drawn,
                self.stated.by_name,
                self.stated.textures,
            ),
        )

    def _body(self, i: int) -> ImportedBody:
        """A body with its chain of joints."""
        m, name = self.model, self.bodies[i]
        indices = range(int(m.body_jntadr[i]), int(m.body_jntadr[i] + m.body_jntnum[i]))
        chain = Chain(np.array(m.body_pos[i]), rotation_of(m.body_quat[i]))
        if m.body_mocapid[i] >= 0:
            self.remarks.add("mocap bodies stay where the model puts them", "body", name)
        free = any(m.jnt_type[j] == FREE for j in indices)
        joints = tuple(self.reader.free(j, chain) if free else self.reader.joint(j, chain) for j in indices)
        # A body turns about an anchor that is not its origin: the origin is fixed to what turns there.
        placement = self.exact.placement(chain.p, chain.R) if chain.is_offset or not joints else None
        parent = int(m.body_parentid[i])
        return ImportedBody(
            name,
            self._inertia(i),
            self.bodies[parent] if parent else WORLD,
            joints,
            placement,
            loads=self._loads(i),
        )

    def _inertia(self, i: int) -> Inertia | None:
        m = self.model
        if m.body_mass[i] == 0.0 and not np.any(m.body_inertia[i]):
            return None
        position, rotation = self.exact.placement(np.array(m.body_ipos[i]), rotation_of(m.body_iquat[i]))
        return Inertia(float(m.body_mass[i]), position, tuple(map(float, m.body_inertia[i])), rotation=rotation)

    def _loads(self, i: int) -> tuple[Load, ...]:
        """Loads on a body by gravity compensation and actuators."""
        lift = -float(self.model.body_gravcomp[i]) * float(self.model.body_mass[i])
        x, y, z = (lift * g for g in self.gravity.tolist())
        acting = self.actuators.loads.get(i, ())
        if not any((x, y, z)) or self.model.body_treeid[i] < 0:
            return acting
        return (Load((x, y, z), at="center_of_mass", axes="world"), *acting)

    def _frames(self) -> dict[int, list[Frame]]:
        """Sites, by the index of their body; the world, with or without any."""
        m = self.model
        frames: dict[int, list[Frame]] = {0: []}
        for s in range(m.nsite):
            frame = Frame(self.sites[s], *self.exact.placement(np.array(m.site_pos[s]), rotation_of(m.site_quat[s])))
            frames.setdefault(int(m.site_bodyid[s]), []).append(frame)
        return frames

    def _remark_ignored(self) -> None:
        m = self.model
        for g in (g for g in range(m.ngeom) if self._touches(g)):
            self.remarks.add(
                "contacts ignored, shapes count by their inertia only", "shape", m.geom(g).name or f"geom{g}"
            )
        if m.opt.density or m.opt.viscosity:
            self.remarks.add("forces of the medium ignored", "option", "density, viscosity")

    def _touches(self, g: int) -> bool:
        """Whether MuJoCo looks for contacts of a shape with one of another body, by the bits of both."""
        m = self.model
        ours = (m.geom_contype & m.geom_conaffinity[g]) | (m.geom_conaffinity & m.geom_contype[g])
        return not m.opt.disableflags & _NO_CONTACTS and bool(np.any(ours[m.geom_bodyid != m.geom_bodyid[g]]))
