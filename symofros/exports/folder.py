"""The folder of an export: ours by its manifest, or not touched."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from symofros.base.names import identifier, package_name
from symofros.base.stored import write_atomically
from symofros.errors import ExportError

MANIFEST = "symofros-export.json"
_FORMAT = 1


@dataclass(frozen=True)
class Exported:
    """Files that an export wrote.

    Attributes:
        folder: Folder of the export.
        target: Kind of export.
        name: Name of the model in C.
        files: Paths, the main one first.
        notes: Remarks on what the format could not hold, and on what else there is to know.
    """

    folder: Path
    target: str
    name: str
    files: tuple[Path, ...]
    notes: tuple[str, ...] = ()


def check_folder(folder: Path) -> dict[str, str]:
    """The files of an earlier export in the folder, with their hashes; empty for a new or an empty folder.

    Raises:
        ExportError: The folder holds something that is not an export of ours, or is no folder.
    """
    if not folder.exists():
        return {}
    if not folder.is_dir():
        raise _foreign_file_error(folder, "a file")
    manifest = folder / MANIFEST
    if not manifest.is_file():
        names = sorted(path.name for path in folder.iterdir())
        if names:
            raise _foreign_file_error(folder, f"{len(names)} entries without {MANIFEST}: {', '.join(names[:6])}")
        return {}
    try:
        stated = json.loads(manifest.read_text(encoding="utf-8"))
        files = stated["files"]
        known = {str(name): str(digest) for name, digest in files.items()}
    except (OSError, ValueError, KeyError, AttributeError, TypeError):
        raise _foreign_file_error(folder, f"a {MANIFEST} that we did not write") from None
    # A manifest is input, too: names that lead out of the folder are not ours.
    return {name: digest for name, digest in known.items() if Path(name).name == name}


def check_same(folder: Path, target: str, name: str) -> None:
    """Refuse a folder with an export of another kind or of another model, whose files a new export would remove.

    Raises:
        ExportError: It holds another export, or something that is none of ours.
    """
    if not check_folder(folder):
        return
    stated = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    same_name = stated.get("name") in (identifier(name), package_name(name))  # Of a description, or of code.
    if stated.get("target") != target or not same_name:
        raise ExportError(
            f"'{folder.name}' holds another export, which would be removed",
            f"'{stated.get('target')}' of '{stated.get('name')}', where '{target}' of '{name}' is to be written",
            "a folder has one export; writing it anew replaces its files",
            "choose another folder",
        )


def _foreign_file_error(folder: Path, found: str) -> ExportError:
    return ExportError(
        f"'{folder}' is not overwritten",
        found,
        "an export goes to a new folder, an empty one, or one of an earlier export",
        "choose another folder, or empty this one yourself",
    )


def write_folder(
    folder: Path, target: str, name: str, files: Mapping[str, str | bytes], generator: str, notes: tuple[str, ...] = ()
) -> Exported:
    """Write an export; each file is there whole or not at all, and the manifest comes last.

    Args:
        folder: Checked again here; made if it does not exist.
        target: Kind of export.
        name: Name of the model in C.
        files: File name -> content, the main one first.
        generator: Name and version of what wrote it.
        notes: Remarks for the user.

    Raises:
        ExportError: The folder is not ours, a file in it was changed by hand, or it can't be written.
    """
    earlier = check_folder(folder)
    for old, digest in earlier.items():
        path = folder / old
        if path.is_file() and _digest(path.read_bytes()) != digest:
            raise ExportError(
                f"'{path}' is not overwritten",
                "it was changed since it was exported",
                "an export replaces only files that are as it wrote them",
                "move your changes elsewhere, or export to another folder",
            )
    contents = {name: text.encode() if isinstance(text, str) else text for name, text in files.items()}
    for new in contents:
        if new not in earlier and (folder / new).exists():
            raise _foreign_file_error(folder, f"'{new}', which no export wrote")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # Both generations are ours until the new one is complete, so that a broken export can be repeated.
        digests = {name: _digest(content) for name, content in contents.items()}
        for new, content in contents.items():
            write_atomically(folder / new, content)
            earlier[new] = digests[new]
            _write_manifest(folder, target, name, generator, earlier)
        for old in set(earlier) - set(contents):
            (folder / old).unlink(missing_ok=True)
        _write_manifest(folder, target, name, generator, digests)
    except OSError as error:
        raise ExportError(
            f"'{folder}' can't be written",
            str(error),
            "a folder that can be written",
            "check its rights and the space left",
        ) from error
    return Exported(folder, target, name, tuple(folder / name for name in contents), notes)


def _write_manifest(folder: Path, target: str, name: str, generator: str, digests: Mapping[str, str]) -> None:
    stated = {"format": _FORMAT, "target": target, "name": name, "generator": generator, "files": dict(digests)}
    write_atomically(folder / MANIFEST, json.dumps(stated, indent=1) + "\n")


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
