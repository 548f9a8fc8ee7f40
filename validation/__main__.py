"""`python -m validation`: do independent engines agree with the generated code, and how good and fast is it?"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from validation.cross_check import report as cross_check
from validation.reporting.command import add_command


@cache
def studies() -> Mapping[str, Any]:
    """The commands beside `check`, by name; this imports the studies and with them all engines."""
    return typer.main.get_group(import_module("validation.commands").app).commands


class Commands(TyperGroup):
    """`check` at hand, the other commands when they are asked for. Typer's own copy of Click has no public types."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Options without a command are those of `check`."""
        is_check = not args or (args[0].startswith("-") and "--help" not in args)
        return super().parse_args(ctx, ["check", *args] if is_check else args)

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of all commands."""
        return [*super().list_commands(ctx), *studies()]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """A command by its name."""
        return super().get_command(ctx, cmd_name) or studies().get(cmd_name)


app = typer.Typer(cls=Commands, add_completion=False, no_args_is_help=False, pretty_exceptions_enable=False)
add_command(app, cross_check.TOPIC)


@app.callback()
def main() -> None:
    """Cross-check the generated code. Without a command: the standard set of robots and reference models."""


if __name__ == "__main__":
    app()
