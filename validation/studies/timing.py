"""Generated C against Pinocchio's C++: loops in C on both sides, one process, interleaved, the same states."""

from __future__ import annotations

import statistics
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import reference_models
import symofros as sf
from reference_models.rigid.chain import chain
from validation.assembly import Assembly, assemble
from validation.cases import standard_set
from validation.geometry import Array
from validation.quantities import ROUNDING
from validation.sampling import sample
from validation.studies.native_build import BuildError, NativeProgram, build, compilers, pin_to_one_cpu
from validation.studies.timing_flexible import FlexibleTiming
from validation.studies.timing_mujoco import MujocoTiming

STATES = 1000
REPEATS = 41
FUNCTIONS = (
    "mass_matrix", "bias", "mass_matrix_and_bias", "mass_matrix_and_bias_batch", "inverse_dynamics_derivatives",
)  # fmt: skip
# Larger models are timed without derivatives, whose code grows with the square of their size.
MOST_DERIVED = 10


@dataclass(frozen=True)
class Timing:
    """One function of one model, by us and by Pinocchio as one compiler built it.

    Attributes:
        model: Its label.
        nv: Degrees of freedom.
        function: What was timed.
        compiler: Of Pinocchio's side.
        ours: Minimum and median, nanoseconds a state; likewise theirs, by the faster of crba's two conventions.
        ratio: Median over the repeats of theirs / ours.
        error: Largest relative difference of the results.
    """

    model: str
    nv: int
    function: str
    compiler: str
    ours: tuple[float, float]
    theirs: tuple[float, float]
    ratio: float
    error: float


def models() -> dict[str, sf.System]:
    """What is timed: arms, a humanoid, a long chain."""
    cases = {case.label: case for case in standard_set()}
    panda = cases["panda"].load().system
    return {
        "panda, 7 joints": replace(panda, name="panda7", bodies=tuple(map(_locked_finger, panda.bodies))),
        "panda, with fingers": panda,
        "ur5": cases["ur5"].load().system,
        "talos": cases["talos"].load().system,
        "mss": reference_models.MODELS["mss"],
        "chain of 22": chain(22, symbolic=False),
        "chain of 52": chain(52, symbolic=False),
    }


def _locked_finger(body: sf.Body) -> sf.Body:
    joint = body.joint
    if joint is None or "finger" not in joint.name:
        return body
    return replace(body, joint=replace(joint, kind="fixed", actuated=False))


@dataclass
class TimingRun:
    """A whole run.

    Attributes:
        timings: What was measured against Pinocchio.
        failures: What could not be built or disagreed, in words.
        flexible: What was measured against Exudyn.
        mujoco: What was measured against MuJoCo.
    """

    timings: list[Timing] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    flexible: list[FlexibleTiming] = field(default_factory=list)
    mujoco: list[MujocoTiming] = field(default_factory=list)


def run_timing(
    chosen: dict[str, sf.System], repeats: int, done: Callable[[str], None] = lambda label: None
) -> TimingRun:
    """Time every model against every build of Pinocchio.

    Args:
        chosen: Label -> system.
        repeats: Interleaved repeats.
        done: Called with each label that is finished.
    """
    run = TimingRun()
    if not chosen:
        return run
    programs: list[NativeProgram] = []
    for compiler in compilers():
        try:
            programs.append(build(compiler))
        except BuildError as error:
            run.failures.append(str(error))
    if not programs and not run.failures:
        run.failures.append("no C++ compiler found: install g++ or clang++")
    for label, system in chosen.items():
        for program in programs:
            try:
                run.timings += time_model(label, system, program, repeats)
            except (BuildError, sf.SymofrosError) as error:
                run.failures.append(f"{label}: {error}")
        done(label)
    return run


def time_model(label: str, system: sf.System, program: NativeProgram, repeats: int) -> list[Timing]:
    """Time one model against one build.

    Raises:
        BuildError: The program failed, or the two sides disagree.
    """
    assembly = assemble(system)
    derivatives = ("inverse_dynamics_derivatives",) if assembly.nv <= MOST_DERIVED else ()
    functions = ("mass_matrix", "bias", "dynamics", *derivatives)
    library, symbol = sf.compile_library(system, sf.Options(functions=functions, batch="loop"))
    vectors, _ = sf.compile_library(system, sf.Options(functions=("dynamics",), batch="vector"))
    states = sample(assembly, 0, STATES)
    with tempfile.TemporaryDirectory() as folder:
        tree, rows = Path(folder) / "tree.txt", Path(folder) / "states.txt"
        tree.write_text(tree_text(assembly), encoding="ascii")
        rows.write_text(_states_text(states.q, states.v), encoding="ascii")
        command = [str(program.path), str(tree), str(rows), str(library), symbol, str(repeats), str(vectors)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, preexec_fn=pin_to_one_cpu)
    if done.returncode != 0:
        raise BuildError(f"the timing program failed with status {done.returncode}: {done.stderr.strip()}")
    return _read(label, assembly.nv, program.compiler, done.stdout)


def tree_text(assembly: Assembly) -> str:
    """A model as numbers, for `validation/native/tree_file.h`."""
    lines = ["symofros-tree 1", "gravity " + _numbers(assembly.gravity), f"bodies {len(assembly.movers)}"]
    for mover in assembly.movers:
        merged = mover.merged()
        moments, axes = np.linalg.eigh(merged.J_BC)
        parts: list[Array] = [mover.axis, mover.X_AP.R, mover.X_AP.p, np.array([merged.mass]), merged.p_BC, merged.J_BC,
                              moments, axes]  # fmt: skip
        lines.append(" ".join(["body", str(mover.parent), mover.kind, *map(_numbers, parts)]))
    return "\n".join(lines) + "\n"


def _numbers(values: Array) -> str:
    return " ".join(repr(float(x)) for x in np.ravel(values))


def _states_text(q: Array, v: Array) -> str:
    return "\n".join([str(len(q)), *(_numbers(np.concatenate(pair)) for pair in zip(q, v, strict=True))]) + "\n"


def _read(label: str, nv: int, compiler: str, text: str) -> list[Timing]:
    errors: dict[str, float] = {}
    times: dict[tuple[str, str], list[float]] = {}
    for line in text.splitlines():
        kind, function, *rest = line.split()
        if kind == "error":
            errors[function] = float(rest[0])
        else:
            times.setdefault((function, rest[0]), []).append(float(rest[2]))
    worst = max(errors.values())
    if not worst <= ROUNDING:
        raise BuildError(f"{label}: the two sides disagree by {worst:.1e}, so their times mean nothing")
    timed = [function for function in FUNCTIONS if (function, "symofros") in times]
    return [_timing(label, nv, compiler, function, times, worst) for function in timed]


def _timing(
    label: str, nv: int, compiler: str, function: str, times: dict[tuple[str, str], list[float]], error: float
) -> Timing:
    ours = times[function, "symofros"]
    theirs = min(
        (times[function, side] for side in ("pinocchio-local", "pinocchio-world") if (function, side) in times),
        key=statistics.median,
    )
    ratio = statistics.median(b / a for a, b in zip(ours, theirs, strict=True))
    return Timing(label, nv, function, compiler, _summary(ours), _summary(theirs), ratio, error)


def _summary(values: Sequence[float]) -> tuple[float, float]:
    return min(values), statistics.median(values)
