"""All hand-written C, and the texts that receive finished strings; README.md says what lies where."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from pathlib import PurePosixPath

# Headers of native/, later ones including earlier ones.
HEADERS = (
    "model/symofros_model.h",
    "stepping/symofros_stepper.h",
    "stepping/instances/symofros_instance.h",
    "stepping/batches/symofros_batch.h",
    "stepping/batches/symofros_hand.h",
    "stepping/posture/symofros_posture.h",
    "diagrams/symofros_diagram.h",
    "diagrams/symofros_program.h",
    "tape/symofros_tape.h",
)
_C_INCLUDE = re.compile(r'^#include "(?P<file>[^"]+\.c)"(?:\n|\Z)', re.MULTILINE)


@cache
def native_text(name: str) -> str:
    """Text of a file of this folder, such as "model/symofros_model.h"."""
    return (files(__name__) / name).read_text(encoding="utf-8")


@cache
def native_number(name: str, macro: str) -> float:
    """Value of a macro that is one number, which a comment may follow, such as SYM_ABI of "model/symofros_model.h"."""
    match = re.search(rf"^#define {macro} +(?P<number>[-+.\de]+)u?(?: +/\*.*)?$", native_text(name), re.MULTILINE)
    if match is None:
        raise LookupError(f"{name} has lost {macro}")
    return float(match["number"])


@cache
def amalgamated(name: str) -> str:
    """Text of a C file with the C files that it includes in their places; headers stay included."""
    folder = PurePosixPath(name).parent

    def included(match: re.Match[str]) -> str:
        parts: list[str] = []
        for part in (folder / match["file"]).parts:
            parts = parts[:-1] if part == ".." else [*parts, part]
        return amalgamated("/".join(parts))

    return _C_INCLUDE.sub(included, native_text(name))


def header_files(*names: str) -> dict[str, str]:
    """File name -> text of headers, as an exported package carries them."""
    return {PurePosixPath(name).name: native_text(name) for name in names}
