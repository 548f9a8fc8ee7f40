"""Times one model in a process of its own.

The messages of `work` are a kind and a value: an "entry" for a pair of sides, the "cost" of a generated function; a
note of what is "skipped", a peer that has no side, or has "failed", one that should have; "doing" with the name of a
function, and "part", what is done of it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import symofros as sf

from .contestants.arrays import first_compiler
from .contestants.engines import mujoco_loops, pinocchio_loops
from .contestants.generated import casadi_loops, sympy_loops
from .contestants.programs import BuildError, Skipped
from .contestants.symofros import BATCH, COLUMNS, NAME, SINGLE, our_loops
from .race import SINGLE_OVER_DOUBLE_ROUNDING, DisagreementError, Times, checked, race
from .record import Entry, Made
from .task import Loop, Task, task

Message = tuple[str, Any]
PEERS = ("pinocchio", "mujoco", "casadi", "sympy")


@dataclass(frozen=True)
class Job:
    """What one worker is to do.

    Attributes:
        model: Label of the model.
        peers: Whom it races.
        functions: Names of the functions.
        repeats: Interleaved.
        states: Number of states in a round.
    """

    model: str
    peers: tuple[str, ...]
    functions: tuple[str, ...]
    repeats: int
    states: int


def work(job: Job) -> Iterator[Message]:
    """Do a job: each result as soon as it is there."""
    with np.errstate(all="ignore"):
        first_compiler()
        given = task(job.model, job.states)
        for function in job.functions:
            yield "doing", function
            try:
                yield from _function(given, job, function)
            except (BuildError, DisagreementError, sf.SymofrosError) as error:
                yield "failed", (job.model, function, "symofros", str(error))


def _function(given: Task, job: Job, function: str) -> Iterator[Message]:
    yield "part", (function, "compiling ours")
    generated = {loop.variant: loop for loop in our_loops(given, [function])}
    expected = generated[NAME].results()
    for name in generated.keys() - {NAME}:
        checked(
            function, name, generated[name].results(), expected, SINGLE_OVER_DOUBLE_ROUNDING if name == SINGLE else 1.0
        )
    sides = dict(generated)
    errors: dict[str, float] = {}
    peers: dict[str, str] = {}
    for peer in job.peers:
        yield "part", (function, f"building {peer}")
        for loop in (yield from _offered(given, job, function, peer)):
            name = f"{peer}: {loop.variant}"
            try:
                errors[name] = checked(function, name, loop.results(), expected)
            except DisagreementError as error:
                yield "failed", (job.model, function, peer, str(error))
                continue
            sides[name], peers[name] = loop, peer
    yield "part", (function, f"racing {len(sides)} sides")
    times = race(sides, job.states, job.repeats)
    yield from _results(given, job, function, sides, peers, errors, times)


def _results(
    given: Task,
    job: Job,
    function: str,
    sides: Mapping[str, Loop],
    peers: Mapping[str, str],
    errors: Mapping[str, float],
    times: Mapping[str, Times],
) -> Iterator[Message]:
    """Entries and costs of a race whose sides are keyed by their names."""
    for name, peer in peers.items():
        entry = Entry(
            job.model,
            given.assembly.nv,
            function,
            peer,
            sides[name].variant,
            generated_time=times[NAME],
            batch=times.get(BATCH),
            peer_time=times[name],
            error=errors[name],
            columns=times.get(COLUMNS),
            single=times.get(SINGLE),
        )
        yield "entry", entry
    for name, loop in sides.items():
        if loop.cost is not None:
            by = peers.get(name, NAME)
            made = Made(
                **vars(loop.cost),
                model=job.model,
                nv=given.assembly.nv,
                function=function,
                by=by,
                variant=loop.variant,
                time=times[name].median,
            )
            yield "cost", made


def _offered(given: Task, job: Job, function: str, peer: str) -> Generator[Message, None, list[Loop]]:
    """The sides of a peer; what it does not have, or could not build, is said."""
    warnings: list[str] = []
    sources: dict[str, Callable[[], Iterator[Loop]]] = {
        "pinocchio": lambda: pinocchio_loops(given, [function], warnings.append),
        "mujoco": lambda: mujoco_loops(given, [function]),
        "casadi": lambda: casadi_loops(given, [function]),
        "sympy": lambda: sympy_loops(given, [function]),
    }
    loops: list[Loop] = []
    try:
        loops = list(sources[peer]())
    except Skipped as error:
        yield "skipped", (job.model, function, peer, str(error))
    except (BuildError, ImportError) as error:
        warnings.append(str(error))
    for text in warnings:
        yield "failed", (job.model, function, peer, text)
    return loops
