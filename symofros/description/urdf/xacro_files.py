"""xacro in: a process with few rights expands the file, and the text is read as URDF."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from symofros.description.packages import NEIGHBOURS, Packages, quoted_folders
from symofros.description.reading import read_bytes, resolved
from symofros.description.urdf import xacro_worker
from symofros.description.workers import answer_of
from symofros.errors import Argument, DescriptionError, Problem

# Wall time of the process [s]; its processor time is bounded by itself.
TIMEOUT = 60
_RULE = (
    "expressions compute (arithmetic, comparisons, indexing, functions of math and a few of Python); files lie in the "
    "package of the file, in one that it finds, or in one that you name; there is no environment"
)


def expanded(path: str | os.PathLike[str], arguments: Mapping[str, str], packages: Packages) -> bytes:
    """The URDF text of a xacro file.

    Args:
        path: The file.
        arguments: Values of its <xacro:arg>.
        packages: Packages that it may find.

    Raises:
        DescriptionError: xacro is not installed, the file can't be expanded, or it asks for what is not allowed.
    """
    file = resolved(Path(path))
    read_bytes(Path(path), xacro_worker.MAX_BYTES)
    task = {
        "file": str(file),
        "folders": [str(folder) for folder in (packages.own, *packages.stated.values())],
        "packages": _texts(packages.at_once),
        "arguments": {k: str(v) for k, v in arguments.items()},
    }
    answer = _answer(task)
    if answer.get("package"):  # Neighbours are looked at once a file asks for another package than its own.
        answer = _answer({**task, "packages": _texts(packages.named)})
    if "absent" in answer:
        raise DescriptionError.of_extra(
            f"'{path}' can't be read: xacro is not installed",
            "no module 'xacro'",
            "xacro expands .xacro files",
            "xacro",
        )
    if name := answer.get("package", ""):
        raise DescriptionError(_unknown_package(name, packages, path))
    if "text" not in answer:
        raise DescriptionError(_not_expanded(f"{answer.get('fault', 'nothing'):.500}", path))
    return str(answer["text"]).encode()


def _not_expanded(fault: str, path: str | os.PathLike[str]) -> Problem:
    trusted = "of a file that you trust, `xacro FILE > robot.urdf` (ROS's own) makes a URDF"
    argument, remedy = None, f"mend it; {trusted}"
    if xacro_worker.OUTSIDE in fault:
        argument = Argument("packages", "FOLDER", "NAME")
        remedy = f"mend its path, or name the folder that it lies in: {argument.call}; {trusted}"
    return Problem("xacro can't expand the file", fault, _RULE, remedy, str(path), argument)


def _texts(folders: Mapping[str, Path]) -> dict[str, str]:
    return {name: str(folder) for name, folder in folders.items()}


def _unknown_package(name: str, packages: Packages, path: str | os.PathLike[str]) -> Problem:
    folders = packages.of(name)
    known = ", ".join(f"'{other:.60}'" for other in [*packages.named][:12])
    argument = Argument("packages", "FOLDER", f"{name:.60}")
    return Problem(
        "xacro can't expand the file: "
        + (f"'{name:.60}' is several packages" if folders else f"there is no package '{name:.60}'"),
        f"$(find {name:.60}), which is {quoted_folders(folders)}"
        if folders
        else f"$(find {name:.60}), with the packages {known}",
        f"packages are that of the file, {NEIGHBOURS}, and those that you name"
        + ("; of several that state one name, that whose folder has it" if folders else ""),
        f"name its folder: {argument.call}",
        os.fspath(path),
        argument,
    )


def _answer(task: Mapping[str, Any]) -> dict[str, Any]:
    bounds = f"more than {xacro_worker.SECONDS} s of processor time, or too much memory"
    return answer_of(xacro_worker.__file__, task, TIMEOUT, bounds)
