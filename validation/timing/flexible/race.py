"""Generated C of the planar flexible robot against Exudyn's mass matrix and right-hand side, at equal accuracy.

Measured in a process of its own, `validation.timing.flexible.worker`: Exudyn's module without range checks has to be
chosen before anything else imports Exudyn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from ...worker_process import WorkerError, WorkerProcess
from ..contestants.programs import BuildError

LABEL = "planar_robot"
# Shape functions a strip: as the model states it, and finer.
COUNTS = (3, 4, 6)
CALLS = 1000
_MEASURE = f"{__package__}.worker", "measure"  # By its name: it imports Exudyn.


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


def run_flexible(repeats: int, counts: Sequence[int] = COUNTS, calls: int = CALLS) -> list[FlexibleTiming]:
    """Time in a process of its own, pinned to one processor, with Exudyn's fast module.

    Args:
        repeats: Interleaved.
        counts: Shape functions a strip, model by model.
        calls: Evaluations a repeat, on either side.

    Raises:
        BuildError: It failed; with its last words.
    """
    try:
        with (
            TemporaryDirectory() as folder,
            WorkerProcess(environment={"EXUDYN_MODULE": "fast"}, log=Path(folder) / "log") as worker,
        ):
            return list(worker.call(_MEASURE, repeats, tuple(counts), calls))
    except WorkerError as error:
        raise BuildError(f"{LABEL} against Exudyn: the worker: {error}") from None
