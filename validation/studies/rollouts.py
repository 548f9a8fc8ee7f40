"""Thousands of motions of an arm at once, ours and MuJoCo's: same method, step and error, loops in C on both sides."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from operator import itemgetter
from statistics import median
from typing import Annotated

import numpy as np
import typer

import symofros as sf

from ..adapters.mujoco import tree as mujoco
from ..adapters.mujoco.motion import roll_out
from ..contract.interface import Subject, Unsupported
from ..mechanics.geometry import Array
from ..reporting.command import Run
from ..reporting.numbers import counted, formatted, times
from ..reporting.record import Data, Fact, Report, Section, Table, Topic
from ..timing.models import DAMPING, STIFFNESS, TARGET, TIMED_MODELS

TRAJECTORIES, STEPS, STEP = 10_000, 100, 1e-3
# Starts about the neutral posture: of each joint [rad], of each speed [rad/s].
_SPREAD, _SPEED = 0.5, 0.5


@dataclass(frozen=True)
class Rollout:
    """One way to move all trajectories.

    Attributes:
        motion: What moves.
        who: Whose loop.
        how: Method and step, in words.
        threads: That share the work.
        error: Error of the joints at the end, the largest over all trajectories, against dop853 at 1e-12 [rad].
        steps: Taken by all trajectories together.
        nanoseconds: Nanoseconds of processor time a step: minimum and median over the repeats.
        ratio: Median over the repeats of MuJoCo's processor time over this; 1 for MuJoCo itself.
    """

    motion: str
    who: str
    how: str
    threads: int
    error: float
    steps: int
    nanoseconds: tuple[float, float]
    ratio: float


def arm() -> sf.System:
    """The 7-joint arm, without the joints' own springs and dampers."""
    return TIMED_MODELS["panda"].load()


def run(repeats: int, trajectories: int = TRAJECTORIES, steps: int = STEPS, threads: int = 1) -> list[Rollout]:
    """PD control and free fall of the arm, each by every side in turn.

    Raises:
        ValueError: MuJoCo can't hold the arm, or a trajectory of ours does not come to its end.
    """
    system = arm()
    engine = mujoco.build(Subject("panda7", system))
    if isinstance(engine, Unsupported):
        raise ValueError(f"MuJoCo: {engine.reason}")
    m = sf.compile(system)
    rng = np.random.default_rng(7)
    q0 = m.neutral() + _SPREAD * rng.standard_normal((trajectories, m.nq))
    v0 = _SPEED * rng.standard_normal((trajectories, m.nv))
    rows = []
    for motion, stiffness, damping in (("PD control", STIFFNESS, DAMPING), ("let go", 0.0, 0.0)):
        rows += _motion(motion, m, engine, (q0, v0), stiffness, damping, steps, repeats, threads)
    return rows


def _motion(
    motion: str,
    m: sf.Model,
    engine: object,
    start: tuple[Array, Array],
    stiffness: float,
    damping: float,
    steps: int,
    repeats: int,
    threads: int,
) -> list[Rollout]:
    span = steps * STEP
    law = None
    if stiffness:
        joints = zip(m.names.u, m.names.q, strict=True)
        law = {u: f"{stiffness}*({TARGET} - {q}) - {damping}*d{q}" for u, q in joints}
    exact = _moved(sf.simulate_batch(m, *start, span, u=law, method="dop853", rtol=1e-12, atol=1e-12)).q_last
    ways = {
        "rk4": {"method": "rk4", "dt": STEP},
        "dopri5": {"method": "dopri5", "rtol": 1e-6, "atol": 1e-9},
        "semi_implicit_euler": {"method": "semi_implicit_euler", "dt": STEP},
    }
    times: dict[str, list[float]] = {name: [] for name in ("mujoco", *ways)}
    errors: dict[str, float] = {}
    counts = {"mujoco": len(start[0]) * steps}
    for _ in range(repeats):
        q, seconds = roll_out(engine, *start, np.full(m.nq, TARGET), stiffness, damping, STEP, steps, threads)
        times["mujoco"].append(seconds)
        errors["mujoco"] = float(np.abs(q - exact).max())
        for name, way in ways.items():
            run = _moved(sf.simulate_batch(m, *start, span, u=law, threads=threads, **way))  # type: ignore[arg-type]
            times[name].append(run.processor_seconds)
            errors[name] = float(np.abs(run.q_last - exact).max())
            counts[name] = int(run.steps.sum() + run.rejected.sum())
    settings = {
        "mujoco": f"RK4, {1e3 * STEP:g} ms",
        "rk4": f"RK4, {1e3 * STEP:g} ms",
        "dopri5": "dopri5, rtol 1e-6",
        "semi_implicit_euler": f"semi-implicit Euler, {1e3 * STEP:g} ms",
    }
    rows = []
    for name, spent in times.items():
        each = [1e9 * x / counts[name] for x in spent]
        ratio = median(mujoco / own for mujoco, own in zip(times["mujoco"], spent, strict=True))
        who = "MuJoCo, rollout" if name == "mujoco" else "SYMOFROS"
        rows.append(
            Rollout(motion, who, settings[name], threads, errors[name], counts[name], (min(each), median(each)), ratio)
        )
    return rows


def _moved(run: sf.Trajectories) -> sf.Trajectories:
    """A batch that came to its end.

    Raises:
        ValueError: It did not, so its time means nothing.
    """
    if not run.ok.all():
        raise ValueError(f"{run.model.record.name}: {run}")
    return run


def measure(
    _: Run,
    trajectories: Annotated[int, typer.Option(min=1, help="Number of motions.")] = TRAJECTORIES,
    steps: Annotated[int, typer.Option(min=1, help="Steps of a millisecond each.")] = STEPS,
    repeats: Annotated[int, typer.Option(min=1, help="Interleaved repeats.")] = 7,
    threads: Annotated[int, typer.Option(min=1, help="Threads of each side.")] = 1,
) -> Data:
    """Time thousands of motions of an arm, against mujoco.rollout."""
    rows = run(repeats, trajectories, steps, threads)
    return {
        "rollouts": [asdict(row) for row in rows],
        "trajectories": trajectories,
        "repeats": repeats,
        "load": os.getloadavg()[0],
    }


_LIMITS = """Loops in C on both sides, in turn, from the same starts; times are the processor's, so that other programs
do not lengthen them, and the loops' alone, without compiling, loading or copying the starts. MuJoCo keeps the state
after each step, we the last one (some nanoseconds a step). The arm's joints are free of friction and of limits on both
sides, and nothing touches; springs and dampers of the joints are the PD control. The ratio is the median over
interleaved repeats of the whole times, so that of an adaptive method is one of time to the end, at the errors shown."""
_HEAD = """motion | who | how | threads | error [rad] | steps | ns a step (min, median) |
    million steps a second and core | MuJoCo's time over it"""
_ROW = "{motion} | {who} | {how} | {threads} | {error:.1e} | {steps} | {} | {rate:.2f} | **{ratio:.1f}**"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows = [{"rate": 1e3 / row["nanoseconds"][0], **row} for row in data["rollouts"]]
    lines = (_ROW.format(formatted(row["nanoseconds"], ".0f"), **row) for row in rows)
    ours = [row for row in rows if "MuJoCo" not in row["who"]]
    fastest, best = (max(ours, key=itemgetter(name)) for name in ("rate", "ratio"))
    title = f"{counted(data['trajectories'], 'motion')} of a 7-joint arm at once"
    repeats = f"{data['repeats']} repeats; load {data['load']:.1f}."
    return Report(
        title,
        f"{title}: {fastest['rate']:.2g} million steps a second and core.",
        None,
        (_LIMITS,),
        (Section("Time of a step", (Table.of(_HEAD, lines), repeats)),),
        facts=(
            Fact(f"{fastest['nanoseconds'][0]:.0f} ns", f"a step: {fastest['motion']}, {fastest['how']}"),
            Fact(times(best["ratio"]), f"mujoco.rollout's time over ours: {best['motion']}, {best['how']}"),
        ),
    )


TOPIC = Topic("rollouts", "Speed", "How fast are thousands of motions at once?", compose, measure)
