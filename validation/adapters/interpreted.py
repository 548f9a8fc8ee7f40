"""SYMOFROS' NumPy interpreter: the same equations without C, so that the two check each other."""

from __future__ import annotations

from validation.adapters.compiled import SymofrosEngine, evaluators
from validation.contract.interface import Subject

NAME = "interpreted"


def build(subject: Subject) -> SymofrosEngine:
    """The model on the interpreter."""
    return SymofrosEngine(NAME, evaluators(subject).interpreted, subject.frames)
