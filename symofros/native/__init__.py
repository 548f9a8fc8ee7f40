"""All hand-written C, and the texts that receive finished strings; README.md says what lies where."""

from __future__ import annotations

from functools import cache
from importlib.resources import files


@cache
def native_text(name: str) -> str:
    """Text of a file of this folder, such as "model/symofros_model.h"."""
    return (files(__name__) / name).read_text(encoding="utf-8")
