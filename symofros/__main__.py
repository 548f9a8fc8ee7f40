"""Command line: symofros info | compile | equations | simulate | export | view | edit | check MODEL, and others."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import symofros as sf
from symofros.errors import did_you_mean

# Name -> module and function. A module is imported when its command is asked for: others need a second of imports.
_COMMANDS = {
    "info": ("symofros.commands.models", "info"),
    "compile": ("symofros.commands.models", "compile_command"),
    "simulate": ("symofros.commands.motion", "simulate"),
    "equations": ("symofros.commands.equations", "equations"),
    "equilibrium": ("symofros.commands.statics", "equilibrium"),
    "advise": ("symofros.commands.uses", "advise"),
    "export": ("symofros.commands.uses", "export_command"),
    "kernels": ("symofros.commands.kernels", "kernels"),
    "edit": ("symofros.commands.uses", "edit"),
    "view": ("symofros.commands.view", "view"),
    "check": ("symofros.commands.harness", "check"),
    "validation": ("symofros.commands.harness", "validation"),
    "cache": ("symofros.commands.cache", "cache"),
}
_OF_THE_HARNESS = ("check", "validation")
_AS_THEY_ARE = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}


@cache
def _command(name: str) -> Any:
    module, function = _COMMANDS[name]
    single = typer.Typer(rich_markup_mode=None)
    settings = _AS_THEY_ARE if name in _OF_THE_HARNESS else None
    single.command(name, context_settings=settings)(getattr(import_module(module), function))
    return typer.main.get_group(single).commands[name]


class Commands(TyperGroup):
    """Commands of the table. Typer's own copy of Click has no public types."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of all commands."""
        return [*_COMMANDS]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """A command by its name."""
        return _command(cmd_name) if cmd_name in _COMMANDS else None

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that arguments begin with; another name is refused with the nearest."""
        if args[0] not in _COMMANDS and not args[0].startswith("-") and not ctx.resilient_parsing:
            remedy = did_you_mean(args[0], _COMMANDS)
            typer.echo(str(sf.Problem(f"no command '{args[0]}'", args[0], ", ".join(_COMMANDS), remedy)), err=True)
            raise typer.Exit(2)
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """A command; what it does not refuse itself is refused here, and never a traceback."""
        try:
            return super().invoke(ctx)
        except (sf.SymofrosError, OSError) as error:
            raise import_module("symofros.commands.shared").refuse(error) from None


# Help states units in brackets, which are no markup.
app = typer.Typer(
    cls=Commands, no_args_is_help=True, rich_markup_mode=None, help="Symbolic multibody models as fast C code."
)


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


if __name__ == "__main__":
    app()
