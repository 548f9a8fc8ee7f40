"""SYMOFROS' C by vectors, several states at a time, as batches call it; what others are compared with runs by state.

Both come from one program, and tests hold them to the same bits; a few functions show it on each model and compiler.
"""

from __future__ import annotations

from ..contract.interface import Subject
from .compiled import SymofrosEngine, evaluators

NAME = "vectors"
FUNCTIONS = ("mass_matrix", "bias", "inverse_dynamics")


def build(subject: Subject) -> SymofrosEngine:
    """The model's C by vectors, of a few functions: it takes long to compile."""
    return SymofrosEngine(NAME, evaluators(subject).by_vectors(FUNCTIONS), subject.frames, frozenset(FUNCTIONS))
