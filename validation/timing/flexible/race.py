"""Generated C of the planar flexible robot against Exudyn's mass matrix and right-hand side, at equal accuracy.

Measured in a process of its own, `validation.timing.flexible.worker`: Exudyn's module without range checks has to be
chosen before anything else imports Exudyn.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

from symofros.harness import worker_command

from ..contestants.programs import BuildError

LABEL = "planar_robot"
# Shape functions a strip: as the model states it, and finer.
COUNTS = (3, 4, 6)
CALLS = 1000
_WORKER = "timing.flexible.worker"


@dataclass(frozen=True)
class FlexibleTiming:
    """One quantity of one pair of models.

    Attributes:
        quantity: What was timed: "M", "M + h", "M + h + Q"; or "M + h + Q, joints", with Exudyn's joints.
        functions: Shape functions a strip of ours.
        elements: Elements a strip of Exudyn's.
        sizes: Our degrees of freedom; Exudyn's coordinates and algebraic equations.
        error: Worst relative error of the frequencies, ours and Exudyn's.
        generated_time: Minimum and median of the generated C, nanoseconds a state.
        engine_time: Minimum and median of Exudyn with the calls from Python, nanoseconds a state.
        calls: Minimum and median of the same calls on a system of one coordinate, nanoseconds a state.
        ratio: Median over the repeats of engine_time / generated_time.
        corrected: Median over the repeats of (engine_time - calls) / generated_time.
    """

    quantity: str
    functions: int
    elements: int
    sizes: tuple[int, int, int]
    error: tuple[float, float]
    generated_time: tuple[float, float]
    engine_time: tuple[float, float]
    calls: tuple[float, float]
    ratio: float
    corrected: float

    @classmethod
    def of(cls, row: Mapping[str, Any]) -> Self:
        """What the worker printed as JSON."""
        values: Iterator[Any] = (row[item.name] for item in fields(cls))
        arguments: list[Any] = [tuple(value) if isinstance(value, list) else value for value in values]
        return cls(*arguments)


def run_flexible(repeats: int, counts: Sequence[int] = COUNTS, calls: int = CALLS) -> list[FlexibleTiming]:
    """Time in a process of its own, pinned to one processor, with Exudyn's fast module.

    Args:
        repeats: Interleaved.
        counts: Shape functions a strip, model by model.
        calls: Evaluations a repeat, on either side.

    Raises:
        BuildError: It failed; with its last words.
    """
    command = worker_command(_WORKER, [str(repeats), str(calls), *map(str, counts)])
    environment = {**os.environ, "EXUDYN_MODULE": "fast"}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode != 0:
        raise BuildError(f"{LABEL} against Exudyn: {(done.stderr.strip() or 'no word').splitlines()[-1]}")
    # Exudyn announces its fast module before.
    return [FlexibleTiming.of(row) for row in json.loads(done.stdout.splitlines()[-1])]
