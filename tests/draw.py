"""What a plain run takes of tests that take long: on average a fifth of a second of each, another draw each day.

`tests/seconds.txt` has what a case of such a test takes; `python -m pytest --update-seconds` measures it anew. A test
of twenty cases of a tenth of a second has two of them in each run; one of three seconds runs every fifteenth day. Of a
file that is named each test takes half a second, and at least a case. What is not drawn is slow: it runs with --slow,
or as a part of that. `--draw WORD` repeats the draw of another run, and the flags of its compiler.
"""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_name("seconds.txt")
HEAD = "# Seconds that a case of a test takes, of tests that take more than {} s: written by --update-seconds.\n"
SHARE = 0.2  # Of a test in a plain run, on average [s].
NAMED = 0.5  # The same where its file is named: by someone who works on it, or for a planted fault.
# Of all files, those whose models compile with the flags that users get.
OPTIMISED = 1 / 8


def test_of(case: str) -> str:
    """The test that a case belongs to, by its id without "tests/"."""
    return case.partition("[")[0].removeprefix("tests/")


def read(text: str) -> dict[str, float]:
    """Test -> seconds of a case."""
    rows = (line.split(maxsplit=1) for line in text.splitlines() if not line.startswith("#"))
    return {test: float(seconds) for seconds, test in rows}


def left_out(cases: Iterable[str], seconds: Mapping[str, float], draw: str, named: bool = False) -> set[str]:
    """The cases that a plain run does not take: ids.

    Args:
        cases: Ids of all cases that are not slow by themselves.
        seconds: Test -> seconds of a case; tests that are not named run whole.
        draw: Word that the others are drawn by.
        named: Whether the files are named, so that at least a case of each test is taken, whatever it takes.
    """
    tests: dict[str, list[str]] = defaultdict(list)
    for case in cases:
        tests[test_of(case)].append(case)
    share, least = (NAMED, 1) if named else (SHARE, 0)
    gone: set[str] = set()
    for test, own in tests.items():
        if test in seconds:
            chance = random.Random(f"{draw} {test}")
            count = max(least, int(share / seconds[test] + chance.random()))  # On average the share, exactly.
            gone |= set(own) - set(chance.sample(sorted(own), min(count, len(own))))
    return gone


def is_optimised(file: str, draw: str) -> bool:
    """Whether the models of a file of tests compile with the flags that users get."""
    return random.Random(f"{draw} {file}").random() < OPTIMISED


class Measurement:
    """Plug-in of pytest that takes the times of a run, and writes those of tests that take more than their share."""

    def __init__(self, file: Path = FILE) -> None:
        self._file = file
        self._spent: dict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))
        self._seen: dict[str, set[str]] = defaultdict(set)

    def pytest_runtest_logreport(self, report: Any) -> None:
        test = test_of(report.nodeid)
        self._seen[test].add(report.nodeid)
        if not report.skipped:
            self._spent[test][report.nodeid] += report.duration

    def pytest_sessionfinish(self) -> None:
        means = {test: sum(cases.values()) / len(cases) for test, cases in self._spent.items()}
        stated = read(self._file.read_text())
        rows = {test: seconds for test, seconds in stated.items() if test not in means}
        counts = {test: len(cases) for test, cases in self._seen.items()}
        rows |= {test: mean for test, mean in means.items() if counts[test] * mean > SHARE}
        lines = [f"{seconds:.2g} {test}\n" for test, seconds in sorted(rows.items())]
        self._file.write_text(HEAD.format(SHARE) + "".join(lines))
