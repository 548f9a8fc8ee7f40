"""SYMOFROS' NumPy interpreter: the same equations without C, so that the two check each other."""

from __future__ import annotations

import symofros as sf
from validation.adapters.compiled import SymofrosEngine, options
from validation.contract.interface import Subject

NAME = "interpreted"


def build(subject: Subject) -> SymofrosEngine:
    """The model on the interpreter."""
    return SymofrosEngine(NAME, sf.compile(subject.system, options(subject, "interpreter")), subject.frames)
