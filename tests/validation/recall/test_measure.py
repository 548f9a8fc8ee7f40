"""The command from a fault's name to its score, by a suite that answers at once, and by the harness."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest
from typer.testing import CliRunner

from validation.__main__ import app
from validation.engines.releases import Opened, Release
from validation.faults.entry import faults
from validation.recall import measure

NAME = "pinocchio_jacobian_rate_aligned"
SUITE = "{python} -c \"print('not ok' if '{version}' == '" + faults()[NAME].wrong + "' else 'ok', '%s')\""


def asked(*arguments: str) -> dict[str, object]:
    done = CliRunner().invoke(app, ["recall", NAME, *arguments, "--json"])
    rows = json.loads(done.stdout)["faults"]
    assert len(rows) == 1
    return dict(rows[0])


@pytest.mark.parametrize("check, score", [("getFrameJacobianTimeVariation of a tip", "hit"), ("colours", "miss")])
def test_a_suite_is_scored(check: str, score: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measure, "kept", lambda folder, requirements: Path(sys.executable))
    monkeypatch.setattr(measure, "size_of", lambda python: 0.0)
    row = asked("--suite", SUITE % check)
    assert (row["score"], row["alarms"], row["cells"]) == (score, 0, 2)


def test_releases_that_can_not_be_asked_are_no_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    @contextmanager
    def none(pairs: Sequence[tuple[object, Release]], folder: Path) -> Iterator[Opened]:
        yield Opened(failures={release: "no wheels" for _, release in pairs})

    monkeypatch.setattr(measure, "opened", none)
    row = asked()
    assert (row["score"], row["why"]) == ("not asked", "no wheels")


def test_a_half_has_its_own_faults_alone() -> None:
    done = CliRunner().invoke(app, ["recall", NAME, "--frozen"])
    assert done.exit_code == 2 and NAME in done.output
