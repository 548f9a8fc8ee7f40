"""Pinocchio: recursive algorithms on rigid trees, by the engine matrix's plug-in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...contract.interface import Subject, Unsupported
from ...mechanics.joint_kinds import PartKind
from ..charted import ChartedEngine
from ..charted import build as build_charted
from ..reach import armature

NAME = "pinocchio"
# Kinds of simple joints that it has.
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "screw", "ball", "free"})


def build(subject: Subject) -> ChartedEngine | Unsupported:
    """Pinocchio's model of a description; it merges what is fixed to a joint's body by itself.

    Each part of a joint is one of Pinocchio's: several of its functions are wrong for composites, as the matrix shows.
    """
    engine = build_charted(NAME, subject, _JOINTS, whole=False, merged=False)
    if isinstance(engine, Unsupported):
        return engine
    # Pinocchio 4.1 counts an armature in the energy of some joints (prismatic, free) and not of others (revolute about
    # a general axis), while its M counts all: with armatures, its kinetic energy is not one to compare with.
    armatures = any(np.any(armature(subject.system, mover)) for mover in subject.assembly.movers)
    return replace(engine, capabilities=engine.capabilities - ({"kinetic_energy"} if armatures else set()))
