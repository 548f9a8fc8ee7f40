"""Records made up for tests."""

from __future__ import annotations

from validation.timing.models import CHAINS
from validation.timing.record import Entry, Made, Record


def entry(
    model: str = "panda",
    function: str = "dynamics",
    peer: str = "pinocchio",
    variant: str = "gcc 12, local",
    ours: float = 100.0,
    theirs: float = 800.0,
    batch: float | None = 20.0,
    columns: float | None = None,
) -> Entry:
    rows, by_columns = (None if time is None else (time - 1.0, time) for time in (batch, columns))
    return Entry(
        model, 7, function, peer, variant, (ours - 1.0, ours), rows, (theirs - 1.0, theirs), 1e-15, "2026", by_columns
    )


def made(
    model: str = "panda", function: str = "dynamics", by: str = "symofros", time: float = 100.0, operations: int = 1000
) -> Made:
    counts = {"mul": operations // 2, "add": operations // 2, "div": 0, "call": 0}
    return Made(model, 7, function, by, "gcc -O3", time, 0.01, 0.3, 40000, 9000, 500, counts, 640)


def cubic() -> Record:
    """Chains whose times grow with n^3 by us and n^1.5 by Pinocchio; operations with n^2."""
    record = Record()
    for n in CHAINS:
        record.entries.append(entry(f"chain{n}", ours=2.0 * n**3, theirs=70.0 * n**1.5, batch=None))
        record.costs.append(made(f"chain{n}", operations=8 * n**2))
    return record
