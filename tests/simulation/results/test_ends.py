"""The tables of how runs end and what they note: a row a status and a kind, shown in docs/howto/simulating.md."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest

from symofros.simulation.results.ends import ENDS
from symofros.simulation.results.notes import NOTES
from symofros.simulation.stepping.status import Status

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "simulating.md"
TABLES: dict[str, Iterable[tuple[str, ...]]] = {
    "| `outcome.kind` | what it means | what to try | in C |\n| --- | --- | --- | --- |\n": [
        (*end, f"`SYM_{Status(status).name}`, {int(status)}") for status, end in ENDS.items()
    ],
    "| a note that says | is said when | what to try |\n| --- | --- | --- |\n": NOTES.values(),
}


def test_each_status_that_ends_a_run_has_a_row() -> None:
    assert set(ENDS) == set(Status) - {Status.RECORDS_FULL}


@pytest.mark.parametrize("head", TABLES)
def test_the_page_shows_the_table(head: str, request: pytest.FixtureRequest) -> None:
    """`--update-golden` writes it."""
    page = PAGE.read_text(encoding="utf-8")
    before, found, rest = page.partition(head)
    shown, _, after = rest.partition("\n\n")
    rows = "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in TABLES[head])
    if request.config.getoption("--update-golden"):
        PAGE.write_text(f"{before}{found}{rows}\n\n{after}", encoding="utf-8")
    else:
        assert found and shown == rows
