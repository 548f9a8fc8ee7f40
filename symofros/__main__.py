"""Command line: symofros info | compile | simulate | advise | export | view | edit | check MODEL; cache; validation."""

from __future__ import annotations

from typing import Annotated

import typer

import symofros as sf
from symofros.commands.cache import cache
from symofros.commands.harness import check, validation
from symofros.commands.models import compile_command, info
from symofros.commands.motion import simulate
from symofros.commands.shared import BAD_INPUT, load
from symofros.commands.statics import equilibrium
from symofros.commands.uses import advise, edit, export_command
from symofros.studio.viewer.command import add_view

# Help states units in brackets, which are no markup.
app = typer.Typer(no_args_is_help=True, rich_markup_mode=None, help="Symbolic multibody models as fast C code.")
AS_THEY_ARE = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}


def _tell_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"symofros {sf.__version__}")
        raise typer.Exit()


@app.callback()
def main(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Symbolic multibody models as fast C code."""


app.command()(info)
app.command("compile")(compile_command)
app.command()(simulate)
app.command()(equilibrium)
app.command()(advise)
app.command("export")(export_command)
app.command()(edit)
add_view(app, load, BAD_INPUT)
app.command("check", context_settings=AS_THEY_ARE)(check)
app.command("validation", context_settings=AS_THEY_ARE)(validation)
app.command()(cache)


if __name__ == "__main__":
    app()
