"""What a report rests on: the sources that its numbers come from, and whether they are still what they were.

A digest is of the text of sources: the package, the reference models, and what the folder of the harness that measures
imports, but for what only draws pages. It is the same in every checkout of a commit, wherever that lies, and does not
know files that are not part of the repository.
"""

from __future__ import annotations

import ast
import hashlib
import subprocess
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import symofros as sf

# Where the harness lies; the reference models lie beside it, and tests where there are any.
HARNESS = Path(__file__).parents[1]
# Files that results depend on, by the end of their names.
_ENDS = frozenset(".c .cpp .cu .diagram .h .in .js .json .mjs .parquet .py .urdf .xml .yaml".split())
# What people look at and click on: no result comes from it.
_LOOKED_AT = ("studio/editor/", "studio/viewer/")
# Folders and files of the harness that only say what was found; a `report.py` measures, too.
_SAYING = frozenset({"reporting", "dashboard", "ci", "figures.py"})
# Folders that are read as files, or imported by name, wherever the harness is used.
_BY_NAME = ("native", "corpus", "adapters", "procedures", "checking.py")
OLDER = "older than the code it judges"
UNKNOWN = "made before reports stated which code they judge"
MIXED = "made while the code changed"


def digest(folder: str, *beside: str) -> str:
    """Digest of the sources that a report rests on.

    Args:
        folder: Folder of the harness that measures.
        beside: Folders beside the harness that it rests on, too, such as "tests".
    """
    total = hashlib.sha256()
    for name, path in sorted(sources(folder, *beside)):
        # Checkouts may end lines as their system does.
        content = hashlib.sha256(path.read_bytes().replace(b"\r\n", b"\n")).hexdigest()
        total.update(f"{name} {content}\n".encode())
    return total.hexdigest()[:16]


def sources(folder: str, *beside: str) -> Iterator[tuple[str, Path]]:
    """The files of these sources, each with its name: that of a root and the path below it."""
    package = Path(sf.__file__).parent
    for name in _listed(package):
        # Installed, the harness and the reference models are folders of the package.
        if not name.startswith((*_LOOKED_AT, f"{HARNESS.name}/", "reference_models/")):
            yield f"symofros/{name}", package / name
    for root in ("reference_models", *beside):
        for name in _listed(HARNESS.parent / root):
            yield f"{root}/{name}", HARNESS.parent / root / name
    reached = _reached(folder)
    for name in _listed(HARNESS):
        first, *_ = parts = name.split("/")
        if first in reached and not _SAYING & set(parts):
            yield f"validation/{name}", HARNESS / name


def _listed(root: Path) -> list[str]:
    """Source files below a folder; in a repository only tracked ones."""
    if not root.is_dir():
        return []
    names = [name for name in _git(root, "ls-files", "-z").split("\0") if name and (root / name).is_file()]
    if not names:  # No repository, or one that this folder is not part of.
        paths = (path for path in root.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
        names = [path.relative_to(root).as_posix() for path in paths]
    return [name for name in names if Path(name).suffix in _ENDS]


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder), *arguments]
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=10, check=True).stdout
    except (OSError, subprocess.SubprocessError):
        return ""


def revision(root: Path = HARNESS.parent) -> str:
    """The repository's revision, "+" where sources differ from it; "" where there is none."""
    names = [name for name in ("symofros", HARNESS.name, "reference_models") if (root / name).is_dir()]
    if not names or not _git(root, "ls-files", "--", *names):
        return ""
    changed = _git(root, "status", "--porcelain", "--untracked-files=no", "--", *names)
    return _git(root, "rev-parse", "HEAD").strip() + ("+" if changed else "")


@cache
def _reached(folder: str) -> frozenset[str]:
    """Folders and files of the harness that one imports, directly or not."""
    found: set[str] = set()
    waiting = [folder, *_BY_NAME]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += _imported(name)
    return frozenset(found)


@cache
def _imported(name: str) -> frozenset[str]:
    """Folders and files of the harness that one of them imports."""
    place = HARNESS / name
    paths = [place] if place.is_file() else [path for path in place.rglob("*.py") if not _SAYING & set(path.parts)]
    found = set()
    for path in paths if place.suffix in ("", ".py") else ():
        parts = path.relative_to(HARNESS).parts[:-1]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and 0 < node.level <= len(parts) + 1:
                base = parts[: len(parts) + 1 - node.level]
                targets = [node.module] if node.module else [alias.name for alias in node.names]
                found |= {(".".join((*base, target))).partition(".")[0] for target in targets}
    return frozenset(one for top in found for one in (top, f"{top}.py") if (HARNESS / one).exists())


def standing_text(standing: str) -> str:
    """Verb and standing, to follow the name of a report in a sentence."""
    return f"{'is' if standing == OLDER else 'was'} {standing}"


def standing(data: Mapping[str, Any], present: str) -> str:
    """What a reader must know of a report's age; "" where its sources are those of now.

    Args:
        data: JSON of the report.
        present: Digest of the sources as they are; "" if it is not known.
    """
    stated = [data.get("digest", ""), *data.get("digests", ())]
    if not all(stated):
        return UNKNOWN
    if any(one == MIXED for one in stated):
        return MIXED
    return OLDER if present and any(one != present for one in stated) else ""
