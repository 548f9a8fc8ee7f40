"""Summaries of earlier commits -> what changed in each report over commits."""

from __future__ import annotations

import re
import subprocess
from itertools import pairwise
from pathlib import Path

from validation.reporting.record import Table

# Commits of the summary that are looked at, the latest ones; changes that are told.
COMMITS, MOST = 40, 15
_COLUMNS = "report = [{name}](#{name}); #since = {date} {commit}; found = {said}; verdict ? ok; before = {before}"


def history(summary: Path, names: tuple[str, ...]) -> Table | None:
    """What reports found since when, and before, by the summaries of the last commits that changed them.

    Returns:
        A line a change, the latest first; None where there is none, or no repository.
    """
    git = ["git", "-C", str(summary.parent)]
    log = _said([*git, "log", f"-{COMMITS}", "--format=%h %cs", "--", summary.name]).splitlines()
    stated = [(line, _stated(_said([*git, "show", f"{line.split()[0]}:./{summary.name}"]))) for line in log]
    rows = []
    for (line, now), (_, before) in pairwise(stated):
        commit, date = line.split()
        for name in names:
            if name in now and now[name] != before.get(name) and now[name][1] != "absent":
                said, verdict = now[name]
                was = ": ".join(reversed(before[name])) if name in before else "not there"
                row = {"name": name, "date": date, "commit": commit, "said": said, "verdict": verdict, "before": was}
                rows.append(row | {"ok": verdict != "missed"})
    return Table.of(rows[:MOST], _COLUMNS) if rows else None


def _stated(text: str) -> dict[str, tuple[str, str]]:
    """What a summary says of each report, and its verdict."""
    rows = re.findall(r"^\| (\w+) \| (.*) \| (?:\*\*missed\*\* )?(\w+) \| [^|]* \|$", text, flags=re.M)
    return {name: (said, verdict) for name, said, verdict in rows}


def _said(command: list[str]) -> str:
    """Output of a command; nothing where it fails."""
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=20, check=True).stdout
    except (OSError, subprocess.SubprocessError):
        return ""
