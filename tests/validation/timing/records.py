"""Records made up for tests."""

from __future__ import annotations

from validation.timing.record import Entry, Made


def entry(
    model: str = "panda",
    function: str = "dynamics",
    peer: str = "pinocchio",
    variant: str = "gcc 12, local",
    generated_time: float = 100.0,
    peer_time: float = 800.0,
    batch: float | None = 20.0,
    columns: float | None = None,
) -> Entry:
    rows, by_columns = (None if time is None else (time - 1.0, time) for time in (batch, columns))
    return Entry(
        model,
        7,
        function,
        peer,
        variant,
        (generated_time - 1.0, generated_time),
        rows,
        (peer_time - 1.0, peer_time),
        1e-15,
        "2026",
        by_columns,
    )


def made(
    model: str = "panda", function: str = "dynamics", by: str = "symofros", time: float = 100.0, operations: int = 1000
) -> Made:
    counts = {"mul": operations // 2, "add": operations // 2, "div": 0, "call": 0}
    return Made(0.01, 0.3, 40000, 9000, 500, counts, 640, model, 7, function, by, "gcc -O3", time)
