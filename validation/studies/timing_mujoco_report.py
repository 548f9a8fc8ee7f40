"""MuJoCo's part of the timing report."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from rich.console import Console
from rich.table import Table

from validation.studies.timing_mujoco import STATES, MujocoTiming

_LIMITS = (
    "MuJoCo is its wheel's own library. M is mj_kinematics, mj_comPos and mj_makeM, left sparse; M + h adds "
    "mj_comVel and mj_rne, sharing the kinematics; forward dynamics adds mj_factorM and mj_solveM. No contacts and "
    f"no passive forces. Where M + h is compared, ours is M + h + Q. {STATES} states, one thread, in turn; "
    "state by state, and in one call of ours that takes several states a vector."
)


def mujoco_lines(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """The section in Markdown; none where nothing was timed."""
    rows = list(rows)
    if not rows:
        return []
    lines = ["", "# Generated C against MuJoCo's C", "", _LIMITS, "",
             "| model | nv | function | ours, ns (min, median) | MuJoCo, ns (min, median) | ratio | in a batch, ns | "
             "ratio |", "|---|---:|---|---:|---:|---:|---:|---:|"]  # fmt: skip
    for row in rows:
        ours, theirs, batch = (", ".join(f"{x:.0f}" for x in row[side]) for side in ("ours", "theirs", "batch"))
        lines.append(f"| {row['model']} | {row['nv']} | {row['function']} | {ours} | {theirs} | "
                     f"**{row['ratio']:.2f}** | {batch} | **{row['batch_ratio']:.1f}** |")  # fmt: skip
    return lines


def show_mujoco(rows: Iterable[MujocoTiming]) -> None:
    """The table for a terminal."""
    rows = list(rows)
    table = Table("model", "nv", "function", "ours [ns]", "MuJoCo [ns]", "ratio", "batch [ns]", "ratio",
                  title="Minimum and median a state")  # fmt: skip
    for row in rows:
        ours, theirs, batch = (f"{low:.0f}, {middle:.0f}" for low, middle in (row.ours, row.theirs, row.batch))
        table.add_row(row.model, str(row.nv), row.function, ours, theirs, f"{row.ratio:.2f}", batch,
                      f"{row.batch_ratio:.1f}")  # fmt: skip
    if rows:
        Console().print(table)
