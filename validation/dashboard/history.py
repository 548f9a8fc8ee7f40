"""Summaries of earlier commits -> what became of each report over commits."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from validation.reporting.record import Cell, Column, Table

# Summaries of so many commits, the latest ones.
MOST = 8


def history(summary: Path, names: tuple[str, ...]) -> Table | None:
    """The first number that each report stated in the summaries of the last commits that changed them.

    Returns:
        A line a report; None where there are no two commits, or no repository.
    """
    git = ["git", "-C", str(summary.parent)]
    commits = _said([*git, "log", f"-{3 * MOST}", "--format=%h %cs", "--", summary.name]).splitlines()
    stated: dict[str, dict[str, Cell]] = {}
    for commit in commits:
        text = _said([*git, "show", f"{commit.split()[0]}:./{summary.name}"])
        cells = dict(re.findall(r"^\| (\w+) \| (.*\|.*) \|$", text, flags=re.M))
        now = {name: _cell(cells[name]) for name in names if name in cells}
        if now and now not in stated.values() and len(stated) < MOST:
            stated[commit] = now
    if len(stated) < 2:
        return None
    columns: dict[str, Column] = {"report": str}
    for commit, cells in reversed(stated.items()):
        short, date = commit.split()
        columns[f"#{date[5:]} {short}"] = lambda name, cells=cells: cells.get(name, "-")  # type: ignore[misc]
    return Table.of(names, columns)


def _cell(line: str) -> Cell:
    said, verdict = line.split(" | ")[:2]
    number = re.search(r"\d+(?: \d{3})*(?: of \d+)?", said)
    return Cell(number[0] if number else "-", verdict != "missed", hint=said)


def _said(command: list[str]) -> str:
    """Output of a command; nothing where it fails."""
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=20, check=True).stdout
    except (OSError, subprocess.SubprocessError):
        return ""
