"""MuJoCo's compiled model -> System: bodies in MuJoCo's order, joints by `mjcf_joints`, and remarks on the rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.description.forces import Load
from symofros.description.frames import Frame
from symofros.description.joints.joint import WORLD, Joint
from symofros.description.mjcf.actuators import ActuatorReader
from symofros.description.mjcf.equalities import EqualityReader
from symofros.description.mjcf.geometry import Exact, rotation_of
from symofros.description.mjcf.joints import FREE, Chain, JointReader
from symofros.description.mjcf.names import Names
from symofros.description.mjcf.numbers import infinite_numbers
from symofros.description.mjcf.visuals import visuals_of
from symofros.description.remarks import Remarks
from symofros.description.system import Inertia, RigidBody, System
from symofros.errors import DescriptionError

_NO_CONTACTS, _NO_GRAVITY = 1 << 4, 1 << 7  # mjDSBL_CONTACT, mjDSBL_GRAVITY


@dataclass(frozen=True)
class Stated:
    """What a compiled model does not say.

    Attributes:
        name: Name of the model.
        file: Main file of the model.
        places: Lines of bodies, joints and constraints, as in System.origin.
    """

    name: str
    file: str
    places: Mapping[tuple[str, ...], str]


class Importer:
    """Turns one compiled model into a description.

    Args:
        model: An MjModel.
        stated: Entries of the document that the compiled model does not keep.
        remarks: Remarks on what is ignored or changed.
        snap_tol: Tolerance of snapping, as in `read_mjcf`.
    """

    def __init__(self, model: Any, stated: Stated, remarks: Remarks, snap_tol: float) -> None:
        self.model = model
        self.stated = stated
        self.remarks = remarks
        self.exact = Exact(snap_tol)
        self.bodies = Names("body", [model.body(i).name for i in range(model.nbody)])
        self.joints = Names("joint", [model.joint(i).name for i in range(model.njnt)])
        self.sites = Names("site", [model.site(i).name for i in range(model.nsite)])
        self.actuators = ActuatorReader(model, self.joints, self.sites, remarks)
        self.reader = JointReader(model, self.joints, self.actuators.efforts, remarks, self.exact)
        off = model.opt.disableflags & _NO_GRAVITY
        self.gravity = np.zeros(3) if off else np.array(model.opt.gravity)

    def system(self) -> System:
        """The description.

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
            frames[i] = (*frames.get(i, ()), *more)
        bodies = [RigidBody(WORLD, frames=frames.get(0, ()))]
        for i in range(1, self.model.nbody):
            bodies += self._body(i, frames.get(i, ()))
        self._remark_ignored()
        origin = {("system",): file, **places}
        gravity = self.exact.vector(self.gravity)
        if self.exact.changed:
            self.remarks.add(
                f"numbers within {self.exact.tolerance:g} of exact ones made exact",
                "number",
                f"{self.exact.changed} of them",
            )
        return System(
            self.stated.name,
            tuple(bodies),
            inputs=tuple(self.actuators.inputs),
            constraints=equalities.constraints,
            gravity=gravity,
            notes=self.remarks.notes(),
            origin=origin,
            visuals=visuals_of(self.model, self.bodies.__getitem__),
        )

    def _body(self, i: int, frames: tuple[Frame, ...]) -> Iterator[RigidBody]:
        """A body, after the massless ones that carry it from joint to joint."""
        m, name = self.model, self.bodies[i]
        indices = range(int(m.body_jntadr[i]), int(m.body_jntadr[i] + m.body_jntnum[i]))
        chain = Chain(self.bodies[int(m.body_parentid[i])], np.array(m.body_pos[i]), rotation_of(m.body_quat[i]))
        if m.body_mocapid[i] >= 0:
            self.remarks.add("mocap bodies stay where the model puts them", "body", name)
        joint: Joint | None = None
        for j in indices:
            if joint is not None:
                carrier = self.bodies.fresh(f"{name}_at_{joint.name}")
                yield RigidBody(carrier, joint)
                chain.parent = carrier
            joint = self.reader.free(j, chain) if m.jnt_type[j] == FREE else self.reader.joint(j, chain)
        if joint is not None and chain.is_offset:
            # A body turns about an anchor that is not its origin: the origin is fixed to what turns there.
            carrier = self.bodies.fresh(f"{name}_at_{joint.name}")
            yield RigidBody(carrier, joint)
            chain.parent, joint = carrier, None
        if joint is None:
            fixed = self.joints.fresh(f"{name}_fixed")
            joint = Joint(fixed, "fixed", chain.parent, None, *self.exact.placement(chain.p, chain.R))
        yield RigidBody(name, joint, self._inertia(i), frames, loads=self._loads(i))

    def _inertia(self, i: int) -> Inertia | None:
        m = self.model
        if m.body_mass[i] == 0.0 and not np.any(m.body_inertia[i]):
            return None
        position, rotation = self.exact.placement(np.array(m.body_ipos[i]), rotation_of(m.body_iquat[i]))
        return Inertia(float(m.body_mass[i]), position, tuple(map(float, m.body_inertia[i])), rotation=rotation)

    def _loads(self, i: int) -> tuple[Load, ...]:
        """What a compensation of gravity and actuators push the body with."""
        lift = -float(self.model.body_gravcomp[i]) * float(self.model.body_mass[i])
        x, y, z = (lift * g for g in self.gravity.tolist())
        acting = self.actuators.loads.get(i, ())
        if not any((x, y, z)) or self.model.body_treeid[i] < 0:
            return acting
        return (Load((x, y, z), at="center_of_mass", axes="world"), *acting)

    def _frames(self) -> dict[int, tuple[Frame, ...]]:
        """Sites, by the index of their body."""
        m = self.model
        frames: dict[int, tuple[Frame, ...]] = {}
        for s in range(m.nsite):
            frame = Frame(self.sites[s], *self.exact.placement(np.array(m.site_pos[s]), rotation_of(m.site_quat[s])))
            body = int(m.site_bodyid[s])
            frames[body] = (*frames.get(body, ()), frame)
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
