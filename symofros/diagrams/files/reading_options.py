"""How the file of a model is read: the entries of a diagram's file that are arguments of `sf.load`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from symofros.description import resolved
from symofros.description.yaml import Node
from symofros.diagrams.files.entries import Entries
from symofros.diagrams.files.fields import Misfit, read
from symofros.diagrams.files.paths import refused
from symofros.loading import Dissipation, LimitsAs

# Entry -> its type; name and meaning are those of the arguments of `sf.load`.
READING: dict[str, Any] = {
    "floating_base": bool,
    "dissipation": Dissipation,
    "limits": LimitsAs,
    "waive": tuple[str, ...],
    "packages": Mapping[str, str],
}


def read_options(entries: Entries, stated: Mapping[str, Node], what: str, base: Path, folder: Path) -> dict[str, Any]:
    """The arguments of `sf.load` that a model states; faults are noted, and what has one is left out.

    Args:
        entries: Reader of the file.
        stated: Entries of the model.
        what: Name of the model, for messages.
        base: Folder of the file.
        folder: Folder of the main diagram, in which packages lie.
    """
    options = {}
    for name, kind in READING.items():
        if name not in stated:
            continue
        try:
            options[name] = read(kind, stated[name])
        except Misfit as error:
            remedy = "see the table of docs/importing.md"
            entries.fault(error.node, f"{what}: {name} does not fit", error.node.plain(), error.rule, remedy)
    for text in options.get("packages", {}).values():
        problem = refused(text, base, folder, is_folder=True)
        entries.take(stated["packages"], [problem] if problem else [])
    if "packages" in options:
        options["packages"] = {name: str(resolved(base / text)) for name, text in options["packages"].items()}
    return options


def reading_entries(options: Mapping[str, Any], folder: Path) -> dict[str, Any] | None:
    """Arguments of `sf.load` as entries of a file in a folder; None where a package lies elsewhere."""
    packages = {name: Path(text) for name, text in options.get("packages", {}).items()}
    if not all(path.is_relative_to(folder) for path in packages.values()):
        return None
    within = {name: path.relative_to(folder).as_posix() for name, path in packages.items()}
    entries = {name: options[name] for name in READING if options.get(name)} | ({"packages": within} if within else {})
    return entries | ({"waive": list(entries["waive"])} if "waive" in entries else {})
