"""The table of how runs end: a row for each status, shown by docs/howto/simulating.md."""

from __future__ import annotations

from pathlib import Path

import pytest

from symofros.simulation.results.ends import ENDS
from symofros.simulation.stepping.status import Status

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "simulating.md"
HEAD = "| `outcome.kind` | what it means | what to try |\n| --- | --- | --- |\n"


def test_each_status_that_ends_a_run_has_a_row() -> None:
    assert set(ENDS) == set(Status) - {Status.RECORDS_FULL}


def test_the_page_shows_the_table(request: pytest.FixtureRequest) -> None:
    """`--update-golden` writes it."""
    page = PAGE.read_text(encoding="utf-8")
    before, found, rest = page.partition(HEAD)
    shown, _, after = rest.partition("\n\n")
    rows = "\n".join(f"| {kind} | {reason} | {advice} |" for kind, reason, advice in ENDS.values())
    if request.config.getoption("--update-golden"):
        PAGE.write_text(f"{before}{found}{rows}\n\n{after}", encoding="utf-8")
    else:
        assert shown == rows
