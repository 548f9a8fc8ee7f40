"""Summaries of earlier commits, read; what changed in each report over commits."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from ..reporting.record import Table, verdict

# Commits of the summary that are read, the latest ones; changes that are listed.
COMMITS, MOST = 40, 15
_ROW = re.compile(r"^\| (\w+) \| (.*) \| (?:\*\*missed\*\* )?(\w+) \| ([^|]*) \|$", re.M)


@dataclass(frozen=True)
class Line:
    """What a summary says of a report: in a sentence, in a word, and when it was made; "" where it does not say."""

    said: str
    word: str
    made: str


@dataclass(frozen=True)
class Stored:
    """The summary of a commit.

    Attributes:
        commit: Abbreviated name of the commit.
        time: When it was committed [s].
        date: The day.
        lines: What it says, by report.
    """

    commit: str
    time: float
    date: str
    lines: Mapping[str, Line]


def stored(summary: Path) -> tuple[Stored, ...]:
    """The summaries of the last commits that changed it, the latest first; none where there is no repository."""

    def git(*arguments: str) -> str:
        command = ["git", "-C", str(summary.parent), *arguments]
        try:
            return subprocess.run(command, capture_output=True, text=True, timeout=20, check=True).stdout
        except (OSError, subprocess.SubprocessError):
            return ""

    found = []
    for entry in git("log", f"-{COMMITS}", "--format=%h %ct %cs", "--", summary.name).splitlines():
        commit, time, date = entry.split()
        rows = _ROW.findall(git("show", f"{commit}:./{summary.name}"))
        lines = {
            name: Line(said, word, made.partition(";")[0].strip(" -").removesuffix(" UTC"))
            for name, said, word, made in rows
        }
        found.append(Stored(commit, float(time), date, lines))
    return tuple(found)


def history(summaries: Sequence[Stored], names: tuple[str, ...]) -> Table:
    """What reports found since when, and before: a line a change, the latest first."""
    rows = []
    for now, before in pairwise(summaries):
        for name in (name for name in names if name in now.lines):
            line, was = now.lines[name], before.lines.get(name, Line("there", "not", ""))
            if (line.said, line.word) != (was.said, was.word) and line.word != "absent":
                found = verdict(line.word, line.word != "missed")
                rows.append((f"[{name}](#{name})", now.date, now.commit, line.said, found, f"{was.word}: {was.said}"))
    return Table.of("report | since | commit | found | verdict | before", rows[:MOST])
