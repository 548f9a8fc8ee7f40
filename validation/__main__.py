"""`python -m validation`: do independent engines agree with the generated code, and how good and fast is it?"""

from __future__ import annotations

import difflib
import sys
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from types import ModuleType
from typing import Any

import typer

import symofros as sf
from symofros.commands.grammar import BAD_INPUT, Group, program


def imported(name: str) -> ModuleType:
    """A module of the harness; where a package that it needs is not installed, that is said, and the program ends."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing in ("", "validation", "symofros"):
            raise
        stated = f"no module {missing}", "the harness is an extra", "pip install 'symofros[validation]'"
        print(sf.Problem("the harness: a package is not installed", *stated), file=sys.stderr)
        raise SystemExit(BAD_INPUT) from None


@cache
def studies() -> Mapping[str, Any]:
    """The commands beside `check`, by name; this imports the studies and with them all engines."""
    return typer.main.get_group(imported("validation.commands").app).commands


@cache
def campaign() -> Any:
    """The commands of campaigns alone: each of their processes would import the studies."""
    app = program()
    imported("validation.campaigns.command").register(app)
    return typer.main.get_group(app).commands["campaign"]


class Commands(Group):
    """`check` at hand, the other commands when they are asked for. Typer's own copy of Click has no public types."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Options without a command are those of `check`."""
        is_check = not args or (args[0].startswith("-") and "--help" not in args)
        return super().parse_args(ctx, ["check", *args] if is_check else args)

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of all commands."""
        return [*super().list_commands(ctx), *studies()]

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that arguments begin with; another name is refused with the nearest."""
        if self.get_command(ctx, args[0]) is None and not ctx.resilient_parsing:
            names = self.list_commands(ctx)
            near = difflib.get_close_matches(args[0], names, n=1)
            remedy = f"did you mean '{near[0]}'?" if near else "check MODEL cross-checks a model"
            print(sf.Problem(f"no command '{args[0]}'", args[0], ", ".join(names), remedy), file=sys.stderr)
            raise SystemExit(BAD_INPUT)
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """A command by its name."""
        known = super().get_command(ctx, cmd_name)
        return known or (campaign() if cmd_name == "campaign" else studies().get(cmd_name))


if __name__ == "__main__" and not {"--help", "--json"} & set(sys.argv):
    # Engines take seconds to load on a busy machine: something is said before.
    print("loading the engines", file=sys.stderr, flush=True)
app = program(cls=Commands, add_completion=False, no_args_is_help=False, pretty_exceptions_enable=False)
imported("validation.reporting.command").add_command(app, imported("validation.cross_check.report").TOPIC)


@app.callback()
def main() -> None:
    """Cross-check the generated code. Without a command: the standard set of robots and reference models."""


if __name__ == "__main__":
    app()
