"""`python -m validation`: do independent engines agree with the generated code, and how good and fast is it?"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from validation.cross_check import report as cross_check
from validation.cross_check.report import WORKERS, Engines, Junit, Seed, States, Workers
from validation.inputs.sampling import DEFAULT_STATES
from validation.reporting.command import REPORTS, AsJson, Output, add_command, execute


@cache
def studies() -> Mapping[str, Any]:
    """The commands beside `check`, by name; this imports the studies and with them all engines."""
    return typer.main.get_group(import_module("validation.commands").app).commands


class Commands(TyperGroup):
    """`check` at hand, the other commands when they are asked for. Typer's own copy of Click has no public types."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of all commands."""
        return [*super().list_commands(ctx), *studies()]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """A command by its name."""
        return super().get_command(ctx, cmd_name) or studies().get(cmd_name)


app = typer.Typer(cls=Commands, add_completion=False, no_args_is_help=False, pretty_exceptions_enable=False)


@app.callback(invoke_without_command=True)
def standard(
    context: typer.Context,
    states: States = DEFAULT_STATES,
    seed: Seed = 0,
    engine: Engines = None,
    junit: Junit = None,
    workers: Workers = WORKERS,
    output: Output = REPORTS,
    as_json: AsJson = False,
) -> None:
    """Cross-check the generated code. Without a command: the standard set of robots and reference models."""
    if context.invoked_subcommand is None:
        options = {"states": states, "seed": seed, "engine": engine, "junit": junit, "workers": workers}
        execute(cross_check.TOPIC, cross_check.measure, output, as_json, cross_check.PRINTED, **options)


add_command(app, cross_check.TOPIC, cross_check.measure, cross_check.PRINTED)

if __name__ == "__main__":
    app()
