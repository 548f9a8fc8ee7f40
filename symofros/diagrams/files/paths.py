"""Files that a diagram refers to: inside its own folder, links followed."""

from __future__ import annotations

from pathlib import Path

from symofros.description import kind_of, resolved
from symofros.errors import Problem, did_you_mean

DIAGRAMS = (".yaml", ".yml")


def refused(
    text: str, base: Path, folder: Path, suffixes: tuple[str, ...] = (), is_folder: bool = False
) -> Problem | None:
    """Why a file may not be read; None if it may.

    Args:
        text: Path as written, relative to base.
        base: The folder of the file that refers to it.
        folder: The main diagram's, resolved; all lies in it or below.
        suffixes: Suffixes that such files have; any by default.
        is_folder: Whether it is a folder, whose files may be read.
    """
    try:
        target = resolved(base / text)
        exists = target.is_dir() if is_folder else target.is_file()
        is_inside = not Path(text).is_absolute() and target.is_relative_to(folder)
    except (OSError, ValueError, RuntimeError) as error:  # A NUL character, a loop of links, too long a name.
        return Problem(f"file '{text:.80}' is no path", str(error), "a relative path", "name a file of this folder")
    if not is_inside:
        return Problem(
            f"file '{text:.80}' leaves the diagram's folder",
            f"{text:.80}",
            "files that a diagram refers to lie in its folder or below, links followed",
            "copy the file there",
        )
    if suffixes and target.suffix.lower() not in suffixes:
        return Problem(
            f"file '{text:.80}' is of another kind",
            target.suffix or "no suffix",
            f"it ends in one of {', '.join(suffixes)}",
            "name another",
        )
    if not exists and is_folder:
        rule = "a package is a folder inside the diagram's"
        return Problem(f"'{text:.80}' is no folder", kind_of(target), rule, "check the path")
    if not exists:
        kind = kind_of(target)
        there = sorted(
            file.name
            for file in target.parent.glob("*")
            if file.is_file() and (not suffixes or file.suffix.lower() in suffixes)
        )
        return Problem(
            f"file '{text:.80}' {'does not exist' if kind == 'no such file' else f'is {kind}'}",
            f"in its folder: {', '.join(there[:8]) or 'none such'}",
            "a file that is referred to exists, and is a regular one",
            did_you_mean(target.name, there) or "check the path",
        )
    return None
