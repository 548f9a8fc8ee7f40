"""Progress of runs with workers: what is awaited, then lines with how many are done, how long it takes yet, and a name.

Pytest says nothing while workers collect, which takes ten seconds and more, and dots have no names.
"""

from __future__ import annotations

import time
from typing import Any

import pytest

# Seconds between lines.
EVERY = 20.0


class Progress:
    """Lines of a run's progress, printed by the process that hands tests to workers.

    Args:
        writer: Pytest's terminal writer: `width_of_current_line`, `line`.
        clock: Seconds since any time.
    """

    def __init__(self, writer: Any, clock: Any = time.monotonic) -> None:
        self._writer, self._clock = writer, clock
        self._total, self._done, self._begin, self._printed = 0, 0, clock(), clock()

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_setupnodes(self, specs: list[Any]) -> None:
        """Workers are to be started."""
        self._tell(f"{len(specs)} workers collect the tests: ten seconds, on a busy machine a minute")

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_node_collection_finished(self, ids: list[str]) -> None:
        """A worker has collected; all collect the same."""
        if not self._total:
            self._total, self._begin = len(ids), self._clock()
            self._tell(f"{self._total} tests")

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """A test is done, or skipped."""
        self._done += 1
        now = self._clock()
        if self._total and now - self._printed >= EVERY:
            left = (now - self._begin) * (self._total / self._done - 1)
            self._tell(f"{self._done} of {self._total}, about {left / 60:.1f} min left; now {nodeid.partition('[')[0]}")

    def _tell(self, text: str) -> None:
        self._printed = self._clock()
        if self._writer.width_of_current_line:  # Of dots.
            self._writer.line()
        self._writer.line(text, flush=True)
