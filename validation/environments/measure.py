"""The command: one process an environment, as what a framework reads at its start holds for all of a process."""

# Annotations are values here: the options of a command name the environments.
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import typer

from ..reporting.command import Quick, Run, known
from ..reporting.plain import plain
from ..reporting.provenance import stamp
from ..reporting.record import Data
from ..timing.worker import Message
from ..worker_process import WorkerError, WorkerProcess
from . import in_node
from .in_casadi import CASADI
from .in_jax import JAX
from .in_torch import TORCH
from .race import TURNS
from .record import Record
from .worker import work

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
    try:
        with (
            TemporaryDirectory() as folder,
            WorkerProcess(environment=SETTINGS[name], log=Path(folder) / "log") as worker,
        ):
            for message in worker.call(work, name, models, STATES, turns):
                take(message, record, doing)
    except WorkerError as error:
        raise RuntimeError(f"the process of {name}: {error}") from None


def take(message: Message, record: Record, doing: Callable[[str], object]) -> None:
    """Add a worker's message to a record."""
    kind, value = message
    if kind == "doing":
        doing(": ".join(value))
    elif kind == "version":
        record.packages[value[0]] = value[1]
    else:
        kept: dict[str, list[Any]] = {"row": record.rows, "absent": record.absent, "failed": record.failed}
        kept[kind].append(value)


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
