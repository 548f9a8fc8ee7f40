"""Command line: symofros info | compile | equations | simulate | export | view | edit | check MODEL, and others."""

from __future__ import annotations

import ast
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

import symofros as sf
from symofros.commands.grammar import TableGroup, program
from symofros.errors import did_you_mean

# Name -> module and function. A module is imported when its command is asked for: others need a second of imports.
_COMMANDS = {
    "info": ("symofros.commands.info", "info"),
    "compile": ("symofros.commands.compile", "compile_command"),
    "simulate": ("symofros.commands.motion", "simulate"),
    "equations": ("symofros.commands.equations", "equations"),
    "equilibrium": ("symofros.commands.statics", "equilibrium"),
    "advise": ("symofros.commands.uses", "advise"),
    "export": ("symofros.commands.uses", "export_command"),
    "kernels": ("symofros.commands.kernels", "kernels"),
    "diff": ("symofros.commands.differences", "diff"),
    "edit": ("symofros.commands.uses", "edit"),
    "view": ("symofros.commands.view", "view"),
    "check": ("symofros.commands.harness", "check"),
    "validation": ("symofros.commands.harness", "validation"),
    "cache": ("symofros.commands.cache", "cache"),
}
_HARNESS_COMMANDS = ("check", "validation")
_PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}


@cache
def _command(name: str) -> Any:
    module, function = _COMMANDS[name]
    single = program()
    settings = _PASS_THROUGH if name in _HARNESS_COMMANDS else None
    single.command(name, context_settings=settings)(getattr(import_module(module), function))
    return typer.main.get_group(single).commands[name]


class Commands(TableGroup):
    """Commands of the table. Typer's own copy of Click has no public types."""

    table = _COMMANDS

    def made(self, name: str) -> Any:
        """A command by its name."""
        return _command(name)

    def listed(self, name: str) -> Any:
        """A command for lists alone: its docstring is read from the source, which takes a tenth of importing it."""
        module, function = _COMMANDS[name]
        spec = find_spec(module)
        try:
            body = ast.parse(Path(str(spec and spec.origin)).read_text(encoding="utf-8")).body
        except OSError:  # Sources are not always files.
            return _command(name)
        (stated,) = (node for node in body if isinstance(node, ast.FunctionDef) and node.name == function)
        return TyperCommand(name, help=ast.get_docstring(stated), rich_markup_mode=None)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that arguments begin with; another name is refused with the nearest."""
        if args[0] not in _COMMANDS and not args[0].startswith("-") and not ctx.resilient_parsing:
            remedy = did_you_mean(args[0], _COMMANDS)
            typer.echo(str(sf.Problem(f"no command '{args[0]}'", args[0], ", ".join(_COMMANDS), remedy)), err=True)
            raise typer.Exit(2)
        return super().resolve_command(ctx, args)


app = program(cls=Commands, no_args_is_help=True, help="Symbolic multibody models as fast C code.")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"symofros {sf.__version__}")
        raise typer.Exit()


@app.callback()
def main(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Symbolic multibody models as fast C code."""


if __name__ == "__main__":
    app()
