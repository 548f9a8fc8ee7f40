"""What reading a file gives, whatever its format, and how its bytes are had within bounds."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from symofros.base.sources import Source
from symofros.description.system import System
from symofros.errors import DescriptionError, Problem

# Of native descriptions; stated here, where no parser of YAML is loaded for it.
YAML_SUFFIXES = (".yaml", ".yml")
USD_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
# Of files that are a whole model by themselves.
MODEL_SUFFIXES = (*YAML_SUFFIXES, ".urdf", ".sdf", ".xml", *USD_SUFFIXES)


@dataclass(frozen=True)
class Reading:
    """The outcome of reading a file: what could be read, and everything that could not.

    Attributes:
        system: System as read, faulty parts left out; None if there is nothing to go on with.
        problems: Every fault of the file.
        broken: Names that the file states but that could not be read; later checks don't report references to them.
        sources: All files that the system was made of; empty where a package reads them, which does not tell.
    """

    system: System | None
    problems: tuple[Problem, ...] = ()
    broken: frozenset[str] = frozenset()
    sources: tuple[Source, ...] = ()


def in_order(problems: Iterable[Problem]) -> tuple[Problem, ...]:
    """The problems in the order of their files and lines."""
    return tuple(sorted(problems, key=_place))


def _place(problem: Problem) -> tuple[str, int]:
    file, _, line = problem.where.rpartition(":")
    return file, int(line) if line.isdigit() else 0


def read_bytes(path: Path, limit: int) -> bytes:
    """The content of a regular file.

    Raises:
        DescriptionError: No such file, not a regular one (a pipe would block), unreadable, or too large.
    """
    try:
        if not path.is_file():
            raise DescriptionError(
                f"'{path}' can't be read", kind_of(path), "a description is a regular file", "check the path"
            )
        with path.open("rb") as stream:
            data = stream.read(limit + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL character in the path.
        reason = getattr(error, "strerror", None) or str(error)
        raise DescriptionError(
            f"{str(path)!r} can't be read", reason, "a description is a file", "check the path"
        ) from None
    refuse_size(path, data, limit)
    return data


def resolved(path: Path) -> Path:
    """The absolute path, links followed; of a loop of links, at which `Path.resolve` raises before Python 3.13, a part.

    Raises:
        ValueError: A NUL character.
    """
    return Path(os.path.realpath(path))


def kind_of(path: Path) -> str:
    """What is at a path that is not a regular file, as a noun phrase for messages."""
    if path.is_symlink() and not os.path.exists(path):
        return "a link that leads nowhere"
    kinds = (
        (path.is_dir, "a folder"),
        (path.is_fifo, "a named pipe, whose reader would wait"),
        (path.is_socket, "a socket"),
        (path.is_char_device, "a device"),
        (path.is_block_device, "a device"),
    )
    return next((kind for holds, kind in kinds if holds()), "no such file")


def refuse_size(path: Path, data: bytes, limit: int) -> None:
    """Refuse the data of a file that is longer than a limit [bytes].

    Raises:
        DescriptionError: More bytes than the limit.
    """
    if len(data) > limit:
        raise DescriptionError(
            f"'{path}' is too large",
            f"more than {limit} bytes",
            "a description with all it includes is at most 4 MiB long, a URDF 16 MiB",
            "check that it is the file you meant",
        )


def fresh_name(wanted: str, taken: set[str]) -> str:
    """The wanted name, with underscores behind it while it is taken; it is taken then."""
    while wanted in taken:
        wanted += "_"
    taken.add(wanted)
    return wanted
