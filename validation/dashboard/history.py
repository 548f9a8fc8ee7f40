"""Summaries of earlier commits -> what changed in each report over commits."""

from __future__ import annotations

import re
import subprocess
from itertools import pairwise
from pathlib import Path

from validation.reporting.record import Table, verdict

# Commits of the summary that are read, the latest ones; changes that are listed.
COMMITS, MOST = 40, 15
_ROW = re.compile(r"^\| (\w+) \| (.*) \| (?:\*\*missed\*\* )?(\w+) \| [^|]* \|$", re.M)


def history(summary: Path, names: tuple[str, ...]) -> Table:
    """What reports found since when, and before, by the summaries of the last commits that changed them.

    Returns:
        A line a change, the latest first; none where there is no repository.
    """

    def git(*arguments: str) -> str:
        command = ["git", "-C", str(summary.parent), *arguments]
        try:
            return subprocess.run(command, capture_output=True, text=True, timeout=20, check=True).stdout
        except (OSError, subprocess.SubprocessError):
            return ""

    rows, stated = [], []
    for line in git("log", f"-{COMMITS}", "--format=%h %cs", "--", summary.name).splitlines():
        reports = _ROW.findall(git("show", f"{line.split()[0]}:./{summary.name}"))
        stated.append((line.split(), {name: (said, word) for name, said, word in reports}))
    for ((commit, date), now), (_, before) in pairwise(stated):
        for name in (name for name in names if name in now and now[name] != before.get(name)):
            said, word = now[name]
            was = ": ".join(reversed(before.get(name, ("there", "not"))))
            if word != "absent":
                rows.append((f"[{name}](#{name})", date, commit, said, verdict(word, word != "missed"), was))
    return Table.of("report | since | commit | found | verdict | before", rows[:MOST])
