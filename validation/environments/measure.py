"""The command: one process an environment, as what a framework reads at its start holds for all of a process."""

# Annotations are values here: the options of a command name the environments.
import json
import os
from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any

import typer

from symofros.harness import worker_command

from ..reporting.command import Quick, Run, known
from ..reporting.plain import plain, restored
from ..reporting.provenance import stamp
from ..reporting.record import Data
from ..timing.processes import WorkerError, follow, message
from . import in_node
from .in_casadi import CASADI
from .in_jax import JAX
from .in_torch import TORCH
from .race import TURNS
from .record import Absent, Record, Row

SETTINGS: Mapping[str, Mapping[str, str]] = {
    in_node.NAME: {},
    **{one.name: one.settings for one in (JAX, TORCH, CASADI)},
}
MODELS = ("panda", "ur5")
STATES = (1, 1024)
_ONLY = f"Only this environment; repeatable. {', '.join(SETTINGS)}."
_MODEL = f"Only this model; repeatable. {', '.join(MODELS)}."


def run_environment(
    name: str, models: list[str], turns: int, record: Record, doing: Callable[[str], object] = lambda said: None
) -> None:
    """Race one environment in a process of its own, and add its results to a record.

    Args:
        name: Name of the environment.
        models: Labels of the models.
        turns: Interleaved turns of each race.
        record: Record that is added to.
        doing: Told what comes next.

    Raises:
        RuntimeError: The process ended before its time; with its last words.
    """
    job = json.dumps({"environment": name, "models": models, "states": STATES, "turns": turns})
    command = worker_command("environments.worker", [job])
    try:
        follow(command, partial(take, record=record, doing=doing), {**os.environ, **SETTINGS[name]})
    except WorkerError as error:
        raise RuntimeError(f"the process {error}") from None


def take(line: str, record: Record, doing: Callable[[str], object]) -> None:
    """Add what a worker printed to a record; lines of other origin are the frameworks', and are left."""
    kind, value = message(line)
    if kind == "doing":
        doing(": ".join(value))
    elif kind == "row":
        record.rows.append(restored(Row, value))
    elif kind == "absent":
        record.absent.append(restored(Absent, value))
    elif kind == "failed":
        record.failed.append(tuple(value))
    elif kind == "version":
        record.packages[value[0]] = value[1]


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--environment", "-e", help=_ONLY)] = None,
    models: Annotated[list[str] | None, typer.Option("--model", help=_MODEL)] = None,
    turns: Annotated[int, typer.Option(min=1, help="Interleaved turns of each race.")] = TURNS,
    quick: Quick = False,
) -> Data:
    """Check and time models in JAX, PyTorch, CasADi and WebAssembly, beside native C and beside peers."""
    names = known(chosen, SETTINGS, "--environment", "environment")
    labels = known(models, MODELS, "--model", "model")
    if quick:
        labels, turns = labels[:1], min(turns, 3)
    run.writes = run.asked or not (chosen or models)
    run.expect(len(names))
    record = Record()

    def work(name: str) -> str:
        run_environment(name, labels, turns, record, lambda said: run.advance(f"{name}: {said}", steps=0))
        run.advance()
        return name

    done = run.each(names, work)
    origin: dict[str, Any] = stamp()
    origin["versions"] = origin["versions"] | record.packages
    return {**origin, **done.head(record.ok, quick), **plain(record), "turns": turns, "environments": names}
