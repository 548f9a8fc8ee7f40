"""A run of the tests says what it waits for, how far it is, and how long it takes yet."""

from __future__ import annotations

from tests.progress import EVERY, Progress


class Reporter:
    def __init__(self) -> None:
        self.lines: list[str] = []

    def ensure_newline(self) -> None:
        pass

    def write_line(self, line: str) -> None:
        self.lines.append(line)


def test_progress_is_told_with_names_and_an_estimate() -> None:
    now, reporter = [0.0], Reporter()
    progress = Progress(reporter, lambda: now[0])
    progress.pytest_xdist_setupnodes([object(), object()])
    assert "2 workers collect" in reporter.lines[-1]
    for _ in range(2):  # Each worker says so.
        progress.pytest_xdist_node_collection_finished(["a.py::t[x]"] * 400)
    assert reporter.lines[1:] == ["400 tests"]
    for _ in range(100):
        now[0] += 1.01 * EVERY / 100
        progress.pytest_runtest_logfinish("tests/a.py::t[x]")
    assert reporter.lines[2:] == ["100 of 400, about 1.0 min left; now tests/a.py::t"]
