"""The command line's reference, written by Typer from the help that the commands print."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import typer
import typer.cli
from sphinx.application import Sphinx

# A page has this where the help of the program of that name is to stand.
PLACE = "<!-- help of {} -->"


def programs() -> Mapping[str, typer.Typer]:
    """The programs by the name under which a shell calls them."""
    from symofros.__main__ import app as symofros
    from validation.__main__ import app as validation

    return {"symofros": symofros, "python -m validation": validation}


def help_of(name: str, app: typer.Typer) -> str:
    """Help of a program and of all its commands, as Markdown with the program as a heading of the second level."""
    command: Any = typer.main.get_command(app)
    text = typer.cli.get_docs_for_click(obj=command, ctx=typer.Context(command, info_name=name), name=name)
    return "\n".join(f"#{line}" if line.startswith("#") else line for line in text.splitlines())


def _insert_help(app: Sphinx, page: str, source: list[str]) -> None:
    if "<!-- help of " in source[0]:
        for name, program in programs().items():
            source[0] = source[0].replace(PLACE.format(name), help_of(name, program))


def setup(app: Sphinx) -> Mapping[str, Any]:
    """Called by Sphinx."""
    app.connect("source-read", _insert_help)
    return {"parallel_read_safe": True}
