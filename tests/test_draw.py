"""A plain run takes other cases of long tests each day, and the same again by the word that it names."""

from __future__ import annotations

from fnmatch import fnmatch
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests import draw

CASES = [f"tests/a.py::many[{k}]" for k in range(20)] + ["tests/a.py::few[1]", "tests/b.py::cheap[1]"]
SECONDS = {"a.py::many": 0.1, "a.py::few": 3.0}


def test_drawn_cases_fit_into_their_share_and_change_by_day() -> None:
    gone = draw.left_out(CASES, SECONDS, "2026-11-27")
    assert len(gone & set(CASES[:20])) == 18 and gone == draw.left_out(CASES[::-1], SECONDS, "2026-11-27")
    days = [draw.left_out(CASES, SECONDS, str(day)) for day in range(100)]
    assert set.intersection(*days) == set(), "a case has no day"
    assert not any(CASES[-1] in gone for gone in days), "a short test runs every day"
    assert 3 <= sum(CASES[20] not in gone for gone in days) <= 12, "three seconds: every fifteenth day"
    named = [draw.left_out(CASES, SECONDS, str(day), named=True) for day in range(100)]
    assert all(len(gone) == 15 and CASES[20] not in gone for gone in named), "half a second, and a case at least"
    files = sum(draw.is_optimised(f"{k}.py", "2026-11-27") for k in range(800))
    assert 60 < files < 140 and draw.is_optimised("a.py", "x") == draw.is_optimised("a.py", "x")


def test_times_are_measured_of_tests_that_take_more_than_their_share(tmp_path: Path) -> None:
    file = tmp_path / "seconds.txt"
    file.write_text("# head\n0.5 a.py::gone\n0.5 a.py::many\n")
    measurement = draw.Measurement(file)
    for case, duration, skipped in [
        (CASES[0], 0.2, False),
        (CASES[0], 0.1, False),
        *((c, 0.0, True) for c in CASES[1:]),
    ]:
        measurement.pytest_runtest_logreport(SimpleNamespace(nodeid=case, duration=duration, skipped=skipped))
    measurement.pytest_runtest_logreport(SimpleNamespace(nodeid=CASES[-1], duration=0.2, skipped=False))
    measurement.pytest_sessionfinish()
    assert draw.read(file.read_text()) == {"a.py::gone": 0.5, "a.py::many": 0.3}


def test_no_folder_of_tests_has_a_name_that_pytest_leaves_out(request: pytest.FixtureRequest) -> None:
    root = Path(__file__).parent
    names = {name for file in root.rglob("test_*.py") for name in file.relative_to(root).parts[:-1]}
    assert not [name for name in names for glob in request.config.getini("norecursedirs") if fnmatch(name, glob)]
