"""Times one model in a process of its own: `python -m validation.timing.worker`.

Arguments: a job as JSON: {"model", "peers", "functions", "repeats", "states"}. Prints a JSON object a line:
{"entry": ...} of a pair of sides, {"cost": ...} of a generated function, {"skipped": ...} of a peer that has no side,
{"failed": ...} of one that should have, {"doing": ...} of a function, {"part": ...} of what is done of it.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass

import numpy as np

import symofros as sf

from ..reporting.plain import restored
from .contestants.arrays import first_compiler
from .contestants.engines import mujoco_loops, pinocchio_loops
from .contestants.generated import casadi_loops, sympy_loops
from .contestants.programs import BuildError, Skipped
from .contestants.symofros import BATCH, COLUMNS, NAME, SINGLE, our_loops
from .processes import Say, say
from .race import SINGLE_OVER_DOUBLE_ROUNDING, DisagreementError, checked, race
from .record import Entry, Made
from .task import Loop, Task, task

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


def work(job: Job, say: Say) -> None:
    """Do a job; `say` gets each result as it is there."""
    first_compiler()
    given = task(job.model, job.states)
    for function in job.functions:
        say("doing", function)
        try:
            _function(given, job, function, say)
        except (BuildError, DisagreementError, sf.SymofrosError) as error:
            say("failed", [job.model, function, "symofros", str(error)])


def _function(given: Task, job: Job, function: str, say: Say) -> None:
    def part(text: str) -> None:
        say("part", [function, text])

    part("compiling ours")
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
        part(f"building {peer}")
        for loop in _offered(given, job, function, peer, say):
            name = f"{peer}: {loop.variant}"
            try:
                errors[name] = checked(function, name, loop.results(), expected)
            except DisagreementError as error:
                say("failed", [job.model, function, peer, str(error)])
                continue
            sides[name], peers[name] = loop, peer
    part(f"racing {len(sides)} sides")
    times = race(sides, job.states, job.repeats)
    for name, peer in peers.items():
        made = Entry(
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
        say("entry", asdict(made))
    for name, loop in sides.items():
        if loop.cost is not None:
            by = peers.get(name, NAME)
            made_by = Made(
                **vars(loop.cost),
                model=job.model,
                nv=given.assembly.nv,
                function=function,
                by=by,
                variant=loop.variant,
                time=times[name].median,
            )
            say("cost", asdict(made_by))


def _offered(given: Task, job: Job, function: str, peer: str, say: Say) -> Iterable[Loop]:
    def warn(text: str) -> None:
        say("failed", [job.model, function, peer, text])

    sources: dict[str, Callable[[], Iterator[Loop]]] = {
        "pinocchio": lambda: pinocchio_loops(given, [function], warn),
        "mujoco": lambda: mujoco_loops(given, [function]),
        "casadi": lambda: casadi_loops(given, [function]),
        "sympy": lambda: sympy_loops(given, [function]),
    }
    try:
        return list(sources[peer]())
    except Skipped as error:
        say("skipped", [job.model, function, peer, str(error)])
    except (BuildError, ImportError) as error:
        warn(str(error))
    return []


def _end_with_parent() -> None:
    """Whatever it computes, the process ends with the one that started it, which holds the other end of the pipe."""
    while os.read(sys.stdin.fileno(), 1):  # Not by `sys.stdin`, the lock of which Python asks for at its own end.
        pass
    os._exit(1)


if __name__ == "__main__":
    threading.Thread(target=_end_with_parent, daemon=True).start()
    np.seterr(all="ignore")
    work(restored(Job, json.loads(sys.argv[1])), say)
