"""MuJoCo's own reading of an MJCF file, by itself and from its path: a second opinion on our importer.

Our importer lets MuJoCo compile a text that it has cut down; here MuJoCo gets the whole file. What the importer says
it ignores is set to zero in the compiled model.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from ...contract.conventions import FREE_WXYZ, Slot
from ...contract.interface import States, Subject, Unsupported
from ...contract.quantities import FRAME_QUANTITIES, MJCF_ROUTE
from ...mechanics.assembly import Mover, assemble
from ...mechanics.geometry import Array
from ..charted import ChartedEngine
from .tree import charted, explain, quiet

NAME = "mujoco-mjcf"

_FREE, _BALL = mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL
_CHARTS = {int(_FREE): FREE_WXYZ, int(_BALL): "quaternion wxyz, body speeds"}
_KINDS = {"free": _FREE, "ball": _BALL, "prismatic": mujoco.mjtJoint.mjJNT_SLIDE}
_NAMELESS = re.compile(r"(body|site)(\d+)\Z")


@dataclass(frozen=True)
class MjcfEngine(ChartedEngine):
    """A model with MuJoCo's own springs, dampers and compensation of gravity.

    Attributes:
        places: Whether each of the subject's frames is a site or a body, and its index.
    """

    places: tuple[tuple[str, int], ...] = ()

    def generalized_force(self, states: States) -> Array:
        """MuJoCo's passive forces; what the inputs add, which it knows nothing of, is taken as stated."""
        forces = self._of_data(states, lambda d: np.array(d.qfrc_passive))
        return self.chart.our_forces(states.q, forces) + states.applied - states.passive

    def frame_pose(self, states: States) -> Array:
        """Poses of sites and bodies: p_WF and the rows of R_WF (N, F, 12)."""

        def one(d: Any, kind: str, i: int) -> Array:
            return np.append(d.site_xpos[i], d.site_xmat[i]) if kind == "site" else np.append(d.xpos[i], d.xmat[i])

        return self._of_data(states, lambda d: np.array([one(d, kind, i) for kind, i in self.places]))

    def _of_data(self, states: States, result: Callable[[Any], Array]) -> Array:
        """Evaluate `result` on MuJoCo's data after a forward pass at each state (N, ...)."""
        d: Any = mujoco.MjData(self.model)
        values = []
        q, v = self.chart.coordinates(states.q), self.chart.speeds(states.q, states.v)
        for d.qpos[:], d.qvel[:] in zip(q, v, strict=True):
            mujoco.mj_forward(self.model, d)
            values.append(result(d))
        return np.array(values)


def build(subject: Subject) -> MjcfEngine | Unsupported:
    """MuJoCo's model of the file that the description was read from."""
    if subject.mjcf is None:
        return Unsupported("not read from an MJCF file")
    with quiet():
        model = _read(subject.mjcf.path)
    if isinstance(model, Unsupported):
        return model
    _forget_what_is_ignored(model)
    assembly = assemble(subject.mjcf.verbatim)
    if model.njnt != len(assembly.movers):
        return Unsupported(f"{model.njnt} joints, ours has {len(assembly.movers)}")
    # Both sides have the joints in the order of the file.
    slots = tuple(_slot(model, j, mover) for j, mover in enumerate(assembly.movers))
    places = tuple(place for name in subject.frames if (place := _frame(model, name)) is not None)
    capabilities = MJCF_ROUTE if len(places) == len(subject.frames) else MJCF_ROUTE - FRAME_QUANTITIES
    return MjcfEngine(**vars(charted(NAME, model, slots, capabilities)), places=places)


def _read(path: Path) -> Any | Unsupported:
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, mujoco.FatalError) as error:
        return Unsupported(f"its own reading of the file: {explain(str(error))}")
    if model.nflex:
        return Unsupported("soft bodies, whose forces the description does not have")
    for j in np.flatnonzero(model.jnt_type == _FREE):
        if model.dof_armature[model.jnt_dofadr[j]]:
            return Unsupported(f"joint '{model.joint(j).name}': an armature along body axes")
    return model


def _forget_what_is_ignored(model: Any) -> None:
    """Set to zero what our importer says it leaves out, and the mass of what never moves."""
    model.body_mass[model.body_treeid < 0] = 0.0
    model.opt.density = model.opt.viscosity = 0.0
    round_joints = (model.jnt_type == _FREE) | (model.jnt_type == _BALL)
    model.jnt_stiffness[round_joints] = 0.0
    model.jnt_stiffnesspoly[round_joints] = 0.0
    model.jnt_stiffnesspoly[:, 0] = 0.0
    model.dof_dampingpoly[:, 1] = 0.0
    model.dof_dampingpoly[np.isin(model.dof_jntid, np.flatnonzero(round_joints))] = 0.0
    for name in ("stiffness", "stiffnesspoly", "damping", "dampingpoly", "armature"):
        getattr(model, f"tendon_{name}")[:] = 0.0
    for name in ("damping", "dampingpoly", "armature"):
        getattr(model, f"actuator_{name}")[:] = 0.0
    # It would count among the forces of actuators, and they are not here.
    model.jnt_actgravcomp[:] = 0


def _slot(model: Any, j: int, mover: Mover) -> Slot:
    kind = int(model.jnt_type[j])
    assert kind == int(_KINDS.get(mover.kind, mujoco.mjtJoint.mjJNT_HINGE)), (kind, mover.kind)
    start = int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j])
    return Slot(mover, *start, _CHARTS.get(kind, ""), grounded=mover.kind == "free")


def _frame(model: Any, name: str) -> tuple[str, int] | None:
    """A site or body; our importer calls nameless ones by kind and index, and a name on several bodies body.site."""
    for kind, type_ in (("body", mujoco.mjtObj.mjOBJ_BODY), ("site", mujoco.mjtObj.mjOBJ_SITE)):
        own = name.rpartition(".")[2] if kind == "site" else name
        for candidate in (name, own):
            if (i := mujoco.mj_name2id(model, type_, candidate)) >= 0:
                return kind, i
    nameless = _NAMELESS.match(name)
    return (nameless[1], int(nameless[2])) if nameless else None
