"""Thousands of motions at once."""

from __future__ import annotations

import os
from dataclasses import asdict
from typing import Annotated

import typer

from validation.reporting.command import Run
from validation.reporting.numbers import counted, times
from validation.reporting.record import Column, Data, Fact, Report, Section, Table, Topic
from validation.studies import rollouts

_LIMITS = (
    "Loops in C on both sides, in turn, from the same starts; times are the processor's, so that other programs do not "
    "lengthen them, and the loops' alone, without compiling, loading or copying the starts. MuJoCo keeps the state "
    "after each step, we the last one (some nanoseconds a step). The arm's joints are free of friction and of limits "
    "on both sides, and nothing touches; springs and dampers of the joints are the PD control. The ratio is the median "
    "over interleaved repeats of the whole times, so that of an adaptive method is one of time to the end, at the "
    "errors shown."
)

_COLUMNS: dict[str, Column] = {
    "motion": "{motion}",
    "who": "{who}",
    "how": "{how}",
    "#threads": "{threads}",
    "#error [rad]": "{error:.1e}",
    "#steps": "{steps}",
    "#ns a step (min, median)": "{nanoseconds:.0f}",
    "#million steps a second and core": lambda row: f"{1e3 / row['nanoseconds'][0]:.2f}",
    "#MuJoCo's time over it": "**{ratio:.1f}**",
}


def measure(
    run: Run,
    trajectories: Annotated[int, typer.Option(min=1, help="Number of motions.")] = rollouts.TRAJECTORIES,
    steps: Annotated[int, typer.Option(min=1, help="Steps of a millisecond each.")] = rollouts.STEPS,
    repeats: Annotated[int, typer.Option(min=1, help="Interleaved repeats.")] = 7,
    threads: Annotated[int, typer.Option(min=1, help="Threads of each side.")] = 1,
) -> Data:
    """Time thousands of motions of an arm, against mujoco.rollout."""
    rows = rollouts.run(repeats, trajectories, steps, threads)
    return {
        "rollouts": [asdict(row) for row in rows],
        "trajectories": trajectories,
        "repeats": repeats,
        "load": os.getloadavg()[0],
    }


def compose(data: Data) -> Report:
    """The report of its JSON."""
    rows = data["rollouts"]
    ours = [row for row in rows if "MuJoCo" not in row["who"]]
    fastest = min(ours, key=lambda row: row["nanoseconds"][0])
    best = max(ours, key=lambda row: row["ratio"])
    title = f"{counted(data['trajectories'], 'motion')} of a 7-joint arm at once"
    rate = 1e3 / fastest["nanoseconds"][0]
    table = Table.of(rows, _COLUMNS)
    return Report(
        title,
        f"{title}: {rate:.2g} million steps a second and core.",
        None,
        (_LIMITS,),
        (Section("Time of a step", (table, f"{data['repeats']} repeats; load {data['load']:.1f}.")),),
        facts=(
            Fact(f"{fastest['nanoseconds'][0]:.0f} ns", f"a step: {fastest['motion']}, {fastest['how']}"),
            Fact(times(best["ratio"]), f"mujoco.rollout's time over ours: {best['motion']}, {best['how']}"),
        ),
    )


TOPIC = Topic("rollouts", "Speed", "How fast are thousands of motions at once?", compose, measure)
