"""`python -m validation`: do independent engines agree with the generated code, and how good and fast is it?"""

from __future__ import annotations

import difflib
import sys
from functools import cache
from importlib import import_module
from types import ModuleType
from typing import Any

import typer
from typer.core import TyperCommand

import symofros as sf
from symofros.commands.grammar import BAD_INPUT, TableGroup, program

from .commands import COMMANDS, EXTRAS, RETIRED


def imported(name: str) -> ModuleType:
    """A module of the harness; where a package that it needs is not installed, that is said, and the program ends."""
    try:
        return import_module(f".{name}", __package__)
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing in ("", "symofros", str(__package__).partition(".")[0]):
            raise
        extra = EXTRAS.get(missing, "validation")
        stated = f"no module {missing}", f"the extra '{extra}' brings it", f"pip install 'symofros[{extra}]'"
        print(sf.Problem("the harness: a package is not installed", *stated), file=sys.stderr)
        raise SystemExit(BAD_INPUT) from None


@cache
def command(name: str) -> Any:
    """A command by its name; this imports its module, and with it the engines that it asks."""
    module, single = imported(COMMANDS[name].module), program()
    if hasattr(module, "register"):
        module.register(single)
    else:
        imported("reporting.command").add_command(single, module.TOPIC)
    return typer.main.get_group(single).commands[name]


class Commands(TableGroup):
    """Commands of the table. Typer's own copy of Click has no public types."""

    table = COMMANDS

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Options without a command are those of `check`."""
        is_check = not args or (args[0].startswith("-") and "--help" not in args)
        return super().parse_args(ctx, ["check", *args] if is_check else args)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that arguments begin with; another name is refused with the nearest."""
        if args[0] not in COMMANDS and not ctx.resilient_parsing:
            near = difflib.get_close_matches(args[0], COMMANDS, n=1)
            remedy = f"did you mean '{near[0]}'?" if near else "check MODEL cross-checks a model"
            if args[0] in RETIRED:
                remedy = f"its question is answered by {RETIRED[args[0]]}"
            print(sf.Problem(f"no command '{args[0]}'", args[0], ", ".join(COMMANDS), remedy), file=sys.stderr)
            raise SystemExit(BAD_INPUT)
        return super().resolve_command(ctx, args)

    def made(self, name: str) -> Any:
        """A command by its name."""
        return command(name)

    def listed(self, name: str) -> Any:
        """A command with its name and summary only, for listings, without importing its module."""
        return TyperCommand(name, help=COMMANDS[name].summary, rich_markup_mode=None)


if __name__ == "__main__" and not {"--help", "--json"} & set(sys.argv):
    # Engines take seconds to load on a busy machine: something is said before.
    print("loading the engines", file=sys.stderr, flush=True)
app = program(cls=Commands, add_completion=False, no_args_is_help=False, pretty_exceptions_enable=False)


@app.callback()
def main() -> None:
    """Cross-check the generated code. Without a command: the standard set of robots and reference models."""


if __name__ == "__main__":
    app()
