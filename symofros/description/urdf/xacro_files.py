"""xacro in: a process with few rights expands the file, and the text is read as URDF."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from symofros.description.reading import read_bytes, resolved
from symofros.description.urdf import xacro_worker
from symofros.description.workers import answer_of
from symofros.errors import DescriptionError, Problem

# Wall time of the process [s]; its processor time is bounded by itself.
TIMEOUT = 60
_RULE = (
    "expressions compute (arithmetic, comparisons, indexing, functions of math and a few of Python); files lie in the "
    "package of the file, or in its folder; environment and other packages are not there"
)


def expanded(path: str | os.PathLike[str], arguments: Mapping[str, str]) -> bytes:
    """The URDF text of a xacro file.

    Args:
        path: The file.
        arguments: Values of its <xacro:arg>.

    Raises:
        DescriptionError: xacro is not installed, the file can't be expanded, or it asks for what is not allowed.
    """
    file = resolved(Path(path))
    read_bytes(Path(path), xacro_worker.MAX_BYTES)
    task = {"file": str(file), "folder": str(_package(file)), "arguments": {k: str(v) for k, v in arguments.items()}}
    answer = _answer(task)
    if "absent" in answer:
        raise DescriptionError(
            Problem.of_extra(
                f"'{path}' can't be read: xacro is not installed",
                "no module 'xacro'",
                "xacro expands .xacro files",
                "xacro",
            )
        )
    if "text" not in answer:
        raise DescriptionError(
            Problem(
                "xacro can't expand the file",
                f"{answer.get('fault', 'nothing'):.500}",
                _RULE,
                "mend it; of a file that you trust, `xacro FILE > robot.urdf` (ROS's own) makes a URDF",
                str(path),
            )
        )
    return str(answer["text"]).encode()


def _package(file: Path) -> Path:
    """The nearest folder above a file with a package.xml, or its own folder."""
    return next((folder for folder in file.parents if (folder / "package.xml").is_file()), file.parent)


def _answer(task: Mapping[str, Any]) -> dict[str, Any]:
    bounds = f"more than {xacro_worker.SECONDS} s of processor time, or too much memory"
    return answer_of(xacro_worker.__file__, task, TIMEOUT, bounds)
