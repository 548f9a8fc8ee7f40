"""`python -m validation`: do independent engines agree with the generated code, and how good and fast is it?"""

from __future__ import annotations

import typer

from validation.campaigns import command as campaign
from validation.cross_check import report as cross_check
from validation.cross_check.report import WORKERS, Engines, Junit, Seed, States, Workers
from validation.dashboard import command as dashboard
from validation.dashboard.catalogue import MEASURES, TOPICS
from validation.inputs.sampling import DEFAULT_STATES
from validation.reporting.command import REPORTS, AsJson, Output, add_command, execute

app = typer.Typer(add_completion=False, no_args_is_help=False, pretty_exceptions_enable=False)


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


for name, measure in MEASURES.items():
    add_command(app, TOPICS[name], measure, cross_check.PRINTED if name == "check" else ())
campaign.register(app)
dashboard.register(app)

if __name__ == "__main__":
    app()
