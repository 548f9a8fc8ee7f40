"""symofros cache: what the folder of compiled models holds, and what of it goes."""

from __future__ import annotations

import json
import time
from typing import Annotated, Any

import typer

import symofros as sf
from symofros.commands.shared import AsJson, refuse
from symofros.commands.terminal import out
from symofros.runtime.build import LIMIT_VARIABLE, Pruned, cache_folder, entries, limit, prune

_MEGABYTE, _DAY = 1e6, 86400.0


def cache(
    to: Annotated[
        float | None, typer.Option("--prune", min=0.0, help="Remove the least recently used until this many MB stay.")
    ] = None,
    days: Annotated[float | None, typer.Option(min=0.0, help="Remove what was not used for so many days.")] = None,
    clear: Annotated[bool, typer.Option("--clear", help="Remove all compiled models.")] = False,
    as_json: AsJson = False,
) -> None:
    """Show the cache of compiled models: folder, size, limit; or make it smaller.

    The folder is $SYMOFROS_CACHE, or symofros in the user's cache folder. $SYMOFROS_CACHE_LIMIT is the number of MB
    that it may hold (4000; 0: no limit), which is kept whenever something is compiled.
    """
    try:
        folder, allowed = cache_folder(), limit()
    except sf.SymofrosError as error:
        raise refuse(error) from None
    pruned = Pruned([], [])
    if clear:
        pruned = prune(folder, -1.0)
    elif to is not None or days is not None:
        pruned = prune(folder, float("inf") if to is None else to * _MEGABYTE, (days or 0.0) * _DAY)
    held = entries(folder)
    libraries = sum(any(file.suffix == ".digest" for file in entry.files) for entry in held)
    size, freed = sum(entry.size for entry in held), sum(entry.size for entry in pruned.removed)
    stated = {
        "folder": str(folder),
        "libraries": libraries,
        "megabytes": round(size / _MEGABYTE, 1),
        "limit": None if allowed == float("inf") else allowed / _MEGABYTE,
        "oldest_days": round((time.time() - held[0].used) / _DAY, 1) if held else 0.0,
        "removed_megabytes": round(freed / _MEGABYTE, 1),
    }
    if as_json:
        print(json.dumps(stated, indent=1))
    else:
        _print_held(stated)
    if pruned.kept:
        what, found = f"'{folder}' keeps files that were to go", f"{len(pruned.kept)} that can't be removed"
        rule = "files go that this user may remove, and no other process has loaded"
        raise refuse(sf.SymofrosError(what, found, rule, "check the folder's rights"))


def _print_held(stated: dict[str, Any]) -> None:
    if stated["removed_megabytes"]:
        out.print(f"removed {stated['removed_megabytes']} MB", markup=False)
    bound = "no limit" if stated["limit"] is None else f"limit {stated['limit']:g} MB ({LIMIT_VARIABLE})"
    out.print(stated["folder"], markup=False, highlight=False, soft_wrap=True)
    count = f"{stated['libraries']} compiled part{'s' * (stated['libraries'] != 1)} of models"
    out.print(f"{count}, {stated['megabytes']} MB; {bound}", markup=False, highlight=False)
    if stated["libraries"]:
        out.print(f"the least recently used: {stated['oldest_days']} days ago", markup=False, highlight=False)
