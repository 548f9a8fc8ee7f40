"""Command line: symofros info | compile | simulate | advise | export | view | edit MODEL."""

from __future__ import annotations

import typer

from symofros.commands.models import compile_command, info
from symofros.commands.motion import simulate
from symofros.commands.shared import BAD_INPUT, load
from symofros.commands.uses import advise, edit, export_command
from symofros.studio.viewer.command import add_view

app = typer.Typer(no_args_is_help=True, add_completion=False, help="Symbolic multibody models as fast C code.")
app.command()(info)
app.command("compile")(compile_command)
app.command()(simulate)
app.command()(advise)
app.command("export")(export_command)
app.command()(edit)
add_view(app, load, BAD_INPUT)


if __name__ == "__main__":
    app()
