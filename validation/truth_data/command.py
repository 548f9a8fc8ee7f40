"""`python -m validation truth`: write the data of symofros-truth, or say whether it is what would be written."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from .. import references
from ..reporting.command import Exit, known
from .catalogue import models
from .dataset import write

FOLDER = references.FOLDER / "truth"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("truth")(truth)


def truth(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of the data.")] = FOLDER,
    model: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    check: Annotated[bool, typer.Option("--check", help="Write nothing; say which files would change.")] = False,
) -> None:
    """Write models, states and right answers to thirty digits as Parquet and JSON, for engines in any language.

    Exit code: 0 written, or nothing would change; 1 something would change; 2 bad input.
    """
    by_name = {item.name: item for item in models()}
    chosen = [by_name[name] for name in known(model, by_name, "--model", "model")]
    if not check:
        write(output, chosen, typer.echo)
        typer.echo(f"written to {output}")
        raise typer.Exit(Exit.GOOD)
    with tempfile.TemporaryDirectory(prefix="symofros-truth-") as private:
        write(Path(private), chosen, typer.echo)
        changed = changes(output, Path(private))
    for name in changed:
        typer.echo(f"would change: {name}")
    typer.echo(f"{len(changed)} files would change" if changed else "the files are what would be written")
    raise typer.Exit(Exit.MISSED if changed else Exit.GOOD)


def changes(folder: Path, fresh: Path) -> list[str]:
    """Files of a fresh copy that differ from those of a folder; versions of libraries may order a Parquet's bytes."""
    names = json.loads((fresh / "manifest.json").read_text(encoding="utf-8"))["files"]
    stored = {name: folder / name for name in names if not name.endswith(".parquet")}
    return [
        name for name, path in stored.items() if not path.is_file() or path.read_bytes() != (fresh / name).read_bytes()
    ]
