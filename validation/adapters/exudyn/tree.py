"""Exudyn's own recursions for rigid trees, ObjectKinematicTree, by the engine matrix's plug-in.

Its joints turn about or slide along one axis. Balls, free joints and screws are none of its kinds: those trees are made
of bodies with Euler parameters (`mapped`).
"""

from __future__ import annotations

from dataclasses import replace

from ...contract.interface import Engine, Subject, Unsupported
from ...mechanics import carried
from ...mechanics.joint_kinds import PartKind
from ..charted import build as build_charted
from ..reach import unrepresented
from . import mapped

NAME = "exudyn"
# States in one call, and columns of Jacobians at all of them: Jacobians are read column by column, each of all links.
MOST_STATES, MOST_COLUMNS = 300, 2000
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic"})


def build(subject: Subject) -> Engine | Unsupported:
    """Exudyn's tree of a rigid description; one of bodies, where a joint is not of its kinds."""
    system, assembly = subject.system, subject.assembly
    beam = next((body for body in system.beams), None)
    if beam is not None:
        return Unsupported(f"beam '{beam.name}': left to finite elements, exudyn-beams")
    if assembly.moves_no_mass:
        return Unsupported("a joint that moves no mass: its systems are solved, which gives NaN")
    obstacle = unrepresented(system, assembly, carried.KINDS)
    if obstacle is not None:
        return obstacle
    if any(mover.kind not in _JOINTS for mover in assembly.movers):
        return mapped.engine(subject, NAME)
    engine = build_charted(NAME, subject, _JOINTS, whole=False, merged=True)
    if isinstance(engine, Unsupported):
        return engine
    most = min(MOST_STATES, MOST_COLUMNS // max(assembly.nv, 1))
    return replace(engine, capabilities=mapped.offered(system), most_states=most)
