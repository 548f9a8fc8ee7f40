"""The command: kernels of some models on this machine's graphics processor, or what they would take of one."""

# Annotations are values here: the options of a command name the models.
import os
from collections.abc import Callable
from functools import partial
from typing import Annotated

import typer

import symofros as sf
from symofros.tools import present

from ..reporting.command import Quick, Run, known
from ..reporting.plain import plain
from ..reporting.record import Data
from . import warp
from .kernels import copied, kernels_of, rollout_rows, row, usages
from .record import PEER, Record
from .states import Subject

MODELS = ("panda", "ur5", "talos")
FUNCTIONS = (
    "dynamics",
    "mass_matrix",
    "bias",
    "forward_dynamics",
    "inverse_dynamics",
    "forward_dynamics_derivatives",
    "inverse_dynamics_derivatives",
)
# Kernels of derivatives of a humanoid take minutes to compile.
_LARGE = {"talos": ("dynamics", "mass_matrix", "bias", "forward_dynamics", "inverse_dynamics")}
# States that are compared with C's.
_STATES = 512
# Without a graphics processor kernels are compiled for this one.
_ARCHITECTURE = "sm_90"
_MODEL = f"Only this model; repeatable. {', '.join(MODELS)}."


def run_model(label: str, functions: tuple[str, ...], record: Record, run: Run) -> None:
    """Add rows of our kernels for a model to a record, and rollouts where a GPU is present."""
    device = present()
    subject = Subject.of(label, _STATES)
    kernels = kernels_of(subject, functions)
    run.expect(len(kernels), label)
    found = usages(kernels, record.architecture, os.cpu_count() or 1)
    for kernel, usage in zip(kernels, found, strict=True):
        run.advance(kernel.title)
        try:
            record.kernels.append(row(kernel, usage, device))
        except sf.SymofrosError as error:
            record.failed.append((label, kernel.title, str(error)))
    if device is not None:
        run.advance(f"{label}: rollouts", steps=0)
        record.rollouts.extend(rollout_rows(subject, device))


def run_peer(label: str, record: Record, run: Run) -> None:
    """Add MuJoCo Warp's rows for a model to a record."""
    run.expect(len(warp.FUNCTIONS), f"{label}: {PEER} compiles its kernels")
    for peer in warp.rows(Subject.of(label, _STATES)):
        record.peers.append(peer)
        run.advance(f"{label}: {PEER}, {peer.task}")


def measure(
    run: Run,
    models: Annotated[list[str] | None, typer.Option("--model", help=_MODEL)] = None,
    quick: Quick = False,
) -> Data:
    """Check and time kernels on a graphics processor, beside C and MuJoCo Warp; without one: registers and spills."""
    labels = known(models, MODELS, "--model", "model")
    if quick:
        labels = labels[:1]
    device = present()
    # Without a graphics processor the report of a machine that has one stays.
    run.writes = run.asked or (device is not None and not models)
    record = Record(absent=warp.missing())
    record.architecture = device.architecture if device else _ARCHITECTURE
    if device is not None:
        record.device, record.copied = device.name, copied(device)
    parts: dict[str, Callable[[], None]] = {}
    for label in labels:
        chosen = FUNCTIONS[:1] if quick else _LARGE.get(label, FUNCTIONS)
        parts[label] = partial(run_model, label, chosen, record, run)
    if device is not None and not record.absent:
        parts |= {f"{label} by {PEER}": partial(run_peer, label, record, run) for label in labels}
    done = run.each(list(parts), lambda part: parts[part]())
    return {**done.head(record.ok, quick), **plain(record)}
