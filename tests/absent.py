"""What a run left out, by what it would take: options of pytest, or extras of the distribution."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable

# Where a run keeps which tests an extra is missing for, for a run in an environment that has it.
CACHED = "symofros/absent"
_TAKES = re.compile(r"run with (--\w+)|needs the extra '([\w-]+)'")


def by_need(skipped: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """Tests by what they need: "--slow", "extra jax", ..., "" for what this machine lacks.

    Args:
        skipped: Id of a test, or of a file that is left out whole, and the reason.
    """
    needs: dict[str, list[str]] = defaultdict(list)
    for node, reason in skipped:
        takes = _TAKES.search(reason)
        needs["" if not takes else takes[1] or f"extra {takes[2]}"].append(node)
    return dict(needs)


def summary(needs: dict[str, list[str]]) -> str:
    """One line: how many for which; "" where nothing was left out."""
    counts = {need: len(set(tests)) for need, tests in needs.items()}
    here = counts.pop("", 0)
    ordered = sorted(counts.items(), key=lambda item: (not item[0].startswith("--"), -item[1]))
    parts = [f"{count} for {need}" for need, count in ordered]
    parts += [f"{here} that this machine can't run" if here else ""]
    said = ", ".join(filter(None, parts))
    return said and f"left out: {said}"
