"""A run of the tests says what it waits for, how far it is, and how long it takes yet."""

from __future__ import annotations

from tests.progress import EVERY, Progress


class Writer:
    def __init__(self) -> None:
        self.lines, self.width_of_current_line = [""], 0

    def write(self, text: str) -> None:
        self.lines[-1] += text
        self.width_of_current_line += len(text)

    def line(self, text: str = "", flush: bool = False) -> None:
        self.write(text)
        self.lines, self.width_of_current_line = [*self.lines, ""], 0


def test_progress_is_told_with_names_and_an_estimate() -> None:
    now, writer = [0.0], Writer()
    progress = Progress(writer, lambda: now[0])
    progress.pytest_xdist_setupnodes([object(), object()])
    assert "2 workers collect" in writer.lines[0]
    for _ in range(2):  # Each worker says so.
        progress.pytest_xdist_node_collection_finished(["a.py::t[x]"] * 400)
    assert writer.lines[1:] == ["400 tests", ""]
    for _ in range(100):
        now[0] += 1.01 * EVERY / 100
        writer.write(".")
        progress.pytest_runtest_logfinish("tests/a.py::t[x]")
    assert writer.lines[2:] == ["." * 100, "100 of 400, about 1.0 min left; now tests/a.py::t", ""]
