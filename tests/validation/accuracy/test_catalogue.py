"""The accuracy report: its quick variant, that it can fail, and its charts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.models import sampled
from validation.__main__ import app
from validation.accuracy import catalogue
from validation.accuracy.catalogue import TOPIC
from validation.accuracy.statics.elastica import exact
from validation.reporting.command import Done, write
from validation.reporting.findings import Finding, Study, exponent, near

# Studies of a second or less; the others take most of the time.
FEW = ("modes_needed", "elastica")


@pytest.fixture(scope="module", params=sampled(("few", "all"), ["few"]))
def quick(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Folder and data of the report: of a few studies in every run, of all with --slow."""
    folder = tmp_path_factory.mktemp("reports")
    chosen = [word for name in FEW for word in ("--study", name)] if request.param == "few" else []
    done = CliRunner().invoke(app, ["accuracy", *chosen, "--quick", "--json", "--report", str(folder)])
    data = json.loads(done.stdout)
    assert done.exit_code == 0, [(c["quantity"], c["value"]) for s in data["studies"].values() for c in s["findings"]]
    return folder, data


def number(data: dict[str, Any], study: str, what: str) -> float:
    """The one number of a study whose name begins so."""
    if study not in data["studies"]:
        assert list(data["studies"]) == list(FEW) and study not in FEW
        pytest.skip("among all studies, with --slow")
    (value,) = (c["value"] for c in data["studies"][study]["findings"] if c["quantity"].startswith(what))
    return float(value)


def test_every_question_is_answered_within_its_bounds(quick: tuple[Path, dict[str, Any]]) -> None:
    _, data = quick
    assert data["ok"] and data["quick"] and not data["failures"]
    assert list(data["studies"]) in (list(FEW), list(catalogue.STUDIES))
    assert all(study["ok"] and study["findings"] and study["figures"] for study in data["studies"].values())


# Closed forms and tables, written here a second time.
@pytest.mark.parametrize(
    ("study", "what", "expected", "relative"),
    [
        ("spinning", "speed of divergence without foreshortening, hub ratio 1", 3.5160152685, 1e-6),
        ("spinup", "3 functions: peak against the exact rod", -0.7505230852, 4e-3),
        ("elastica", "deflection over L at which the error reaches 5 %", 0.2144882, 1e-2),
        ("estimate", "force at the tip: largest factor", 1.01138, 1e-2),
        ("buckling", "Euler's load, legendre, 5 functions", np.pi**2 / 4, 1e-8),
        ("buckling", "buckling under its weight", 7.837347, 1e-6),
        ("buckling", "lateral buckling, 4 functions", 4.016, 2e-4),
        ("damping", "logarithmic decrement", 0.1259484, 1e-6),
        ("pendulum", "stiff: largest deflection", 0.0120579, 2e-3),
        ("conditioning", "legendre: condition number with 8", 3.8, 1e-12),
    ],
)
def test_numbers(quick: tuple[Path, dict[str, Any]], study: str, what: str, expected: float, relative: float) -> None:
    assert number(quick[1], study, what) == pytest.approx(expected, rel=relative)


def test_families_converge_with_their_exponents(quick: tuple[Path, dict[str, Any]]) -> None:
    _, data = quick
    assert number(data, "energy", "first order: exponent") > 1.9
    assert number(data, "convergence", "cubic splines: exponent") == pytest.approx(4.0, abs=0.7)
    assert number(data, "convergence", "cantilever modes: exponent") == pytest.approx(4.0, abs=0.7)
    assert number(data, "convergence", "Legendre: decades") > 0.7


def test_a_missed_bound_fails_the_command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    missed = Study("Does it fail?", "Yes.", (), (Finding("zero", 1.0, 0.0),))
    monkeypatch.setitem(catalogue.STUDIES, "spinning", lambda quick: missed)
    done = CliRunner().invoke(app, ["accuracy", "--study", "spinning", "--report", str(tmp_path)])
    assert done.exit_code == 1 and "1 miss their bounds" in done.stdout
    assert "**missed** 1" in (tmp_path / "accuracy.md").read_text()


def test_a_study_that_can_not_be_done_fails_the_command_and_no_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def broken(quick: bool) -> Study:
        raise ArithmeticError("diverged")

    monkeypatch.setitem(catalogue.STUDIES, "spinning", broken)
    command = ["accuracy", "--study", "spinning", "--study", "elastica", "--quick", "--json", "--report", str(tmp_path)]
    done = CliRunner().invoke(app, command)
    data = json.loads(done.stdout)
    assert done.exit_code == 1 and not data["ok"] and data["studies"]["elastica"]["ok"]
    assert data["failures"] == {"spinning": "ArithmeticError: diverged"}


@pytest.mark.parametrize(("found", "ok"), [(1.0, True), (1.011, False), (0.989, False), (np.nan, False)])
def test_bounds(found: float, ok: bool) -> None:
    assert near("x", found, 1.0, 0.01, "").ok is ok
    assert near("x", -found, -1.0, 0.01, "").ok is ok


def test_nothing_asked_is_not_a_success(tmp_path: Path) -> None:
    data = Done().head(True, False) | {"studies": {}}
    assert write(TOPIC, data, tmp_path).ok is False and (tmp_path / "accuracy.html").is_file()


def test_exponent_of_a_power_law() -> None:
    n = np.array([2.0, 4.0, 8.0])
    assert exponent(n, 3.0 * n**-2.5) == pytest.approx(2.5, rel=1e-12)


def test_elastica_at_small_loads() -> None:
    deflection, shortening = exact(0.01)
    # y = a/3 (1 - 4 a^2/35 + ...), u = a^2/15 to first order.
    assert deflection == pytest.approx(0.01 / 3 * (1 - 4e-4 / 35), rel=1e-7)
    assert shortening == pytest.approx(1e-4 / 15, rel=1e-4)
