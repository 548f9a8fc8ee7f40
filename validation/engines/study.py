"""The command that measures the matrix."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from ..faults.environment import NotAskedError
from ..reporting.command import Exit, Run, known
from ..reporting.record import Data
from . import changes, parts, releases
from .asking import about, questions, within_a_minute
from .bisection import history
from .causes.history import histories, named
from .proving.shrink import TRIES
from .renewal import Found, measured, report_of
from .verdicts import Cell
from .workers import registry


def measure(
    run: Run,
    engines: Annotated[list[str] | None, typer.Option("--engine", help="Only this engine.")] = None,
    models: Annotated[list[str] | None, typer.Option("--kinds", help="Only this kind of joint, or tree.")] = None,
    prove: Annotated[bool, typer.Option(help="Shrink red cells, write their scripts and run them.")] = True,
    tries: Annotated[int, typer.Option(min=0, help="Cases tried to shrink each fault.")] = TRIES,
    part: Annotated[
        list[Path] | None,
        typer.Option(help="Take over what a stored engines.json has of the same questions; repeatable."),
    ] = None,
    update: Annotated[
        bool, typer.Option("--update", help="Take over what the report that is there has; ask what is new or changed.")
    ] = False,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME==VERSION", help="This release, in an environment of its own; NAME: the newest."),
    ] = None,
    newest: Annotated[
        bool, typer.Option("--newest", help="The newest release of every engine, each likewise.")
    ] = False,
    requires: Annotated[
        list[str] | None, typer.Option("--with", metavar="REQUIREMENT", help="Install this beside the release, too.")
    ] = None,
    environments: Annotated[Path | None, typer.Option(help="Folder of releases' environments.")] = None,
    smoke: Annotated[
        bool, typer.Option("--smoke", help="What fits into a minute for each engine; no scripts.")
    ] = False,
    baseline: Annotated[
        Path | None, typer.Option(help="Say which cells changed against a stored engines.json.")
    ] = None,
    bisect: Annotated[
        str | None,
        typer.Option(metavar="ENGINE/TREE/FUNCTION[=VERDICT]", help="First bad and first good release of this cell."),
    ] = None,
    since: Annotated[
        list[str] | None,
        typer.Option(
            "--releases", metavar="ENGINE[/CAUSE]", help="First and last release of a cause, by its script; stored."
        ),
    ] = None,
) -> Data:
    """Hold engines against thirty digits of truth: every kind of joint, every function that they offer.

    A run may be made in parts: --engine for some engines, into a folder of their own; then once more with --part for
    each folder's engines.json. --update takes over the report that is there. What is taken over is what answers the
    same question to the same release by the same code; all else is asked, and all that engines that are named are
    asked. Files are written for all questions to all engines, or into a folder that is named.
    """
    at = releases.newest() if newest else at or []
    if bisect:
        raise typer.Exit(_bisected(bisect, at, requires or (), environments))
    if since:
        raise typer.Exit(_dated(since, run.folder / "engines.json", requires or (), environments))
    plugins = registry().plugins
    present = {name: plugin for name, plugin in plugins.items() if plugin.version()}
    try:
        stored, before = parts.load([*(part or ()), *_report(run, update)]), changes.load(baseline)
        pairs = [pair for text in at for pair in releases.stated(text, requires or ())]
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    with_parts = parts.engines_of(stored)
    wished = known(engines, present, "--engine", "engine present")
    chosen = {name: plugin for name, plugin in present.items() if name in wished or name in with_parts}
    every = questions()
    wanted = {name: every[name] for name in known(models, every, "--kinds", "kind")}
    # A part of the questions or of the engines, or other releases than those of this environment, leave the whole
    # report as it is.
    asks_all = chosen.keys() | with_parts >= set(present) and set(wanted) == set(every)
    run.writes = run.asked or (asks_all and not (at or smoke))
    with releases.in_reach(chosen, pairs, environments) as reach:
        for why in reach.failures.values():
            run.say(why, bad=True)
        if pairs and not reach.plugins:
            raise typer.Exit(Exit.MISSED)
        run.expect(len(wanted), "asking engines")
        if smoke:
            cells = within_a_minute(reach, wanted)
            done = {one.cell.model for one in cells}
            found = Found(reach, {name: one for name, one in wanted.items() if name in done}, cells)
        else:
            found = measured(run, reach, wanted, stored, engines or (), tries if prove and run.writes else None)
    absent = {name: plugin.extra for name, plugin in plugins.items() if name not in present} | registry().failures
    absent = {str(release): why for release, why in reach.failures.items()} if at else absent
    whole = report_of(found, absent)
    if run.writes:
        parts.write_scripts(whole["proofs"], run.folder / "engines")
    return dict(whole) | ({"changed": changes.between(before, whole)} if before else {})


def _bisected(cell: str, at: Sequence[str], requires: Sequence[str], environments: Path | None) -> Exit:
    """Print the history of a cell; the exit code."""
    engine, _, rest = cell.partition("/")
    (tree,) = known([rest.rpartition("/")[0]], questions(), "--bisect", "tree")
    question, version = {tree: questions()[tree]}, at[0].partition("==")[2] if at else ""

    def ask(reach: releases.Opened) -> list[Cell]:
        return [one.cell for one in about(reach.plugins, question, reach.worker, str)[0]]

    try:
        (pair,) = releases.stated(f"{engine}=={version}", requires)
        for line in history(cell, pair, requires, environments, ask):
            typer.echo(line)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--bisect") from None
    except NotAskedError as error:
        typer.echo(str(error))
        return Exit.MISSED
    return Exit.GOOD


def _dated(names: Sequence[str], report: Path, requires: Sequence[str], environments: Path | None) -> Exit:
    """Print which releases have causes, by the scripts of a stored report; the exit code."""
    try:
        chosen, data = named(names), changes.load(report)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--releases") from None
    for line in histories(chosen, data or {}, requires, environments):
        typer.echo(line)
    return Exit.GOOD


def _report(run: Run, update: bool) -> list[Path]:
    """The stored report that an update begins from; none where there is none yet."""
    path = run.folder / "engines.json"
    return [path] if update and path.exists() else []
