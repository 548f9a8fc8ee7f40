"""What a user waits for: each run a process with the cache it is to have; what failed is said; the table judges."""

from __future__ import annotations

from pathlib import Path

import pytest

from validation.reporting.record import Table
from validation.timing.record import Record, Wait, as_data
from validation.timing.report import TOPIC
from validation.timing.tables import sections
from validation.timing.waits import process_time

MARK = """
import os, pathlib
folder = pathlib.Path(os.environ["SYMOFROS_CACHE"])
print(folder, len(list(folder.iterdir())))
assert not list(folder.iterdir()), "the cache is not empty"
(folder / "mark").touch()
"""


def test_each_run_with_an_empty_cache_has_a_new_one() -> None:
    assert 0.0 < process_time(("-c", MARK), None, 2) < 60.0


def test_runs_with_a_full_cache_share_it_and_failures_are_told(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="the cache is not empty"):
        process_time(("-c", MARK), tmp_path, 2)


def test_the_report_shows_waits_and_what_is_missed() -> None:
    record = Record(waits=[Wait("import symofros", "", 0.15, 0.1), Wait("first M", "panda", 0.3, None)])
    report = TOPIC.compose(as_data(record))
    assert report.missed == ("import symofros: 0.15 s, asked is at most 0.1 s",) and not report.ok
    (table,) = (block for part in sections(record) if part.anchor == "first-second" for block in part.blocks[1:])
    assert isinstance(table, Table) and table.rows[1] == ("first M", "panda", "0.3 s", "-")
