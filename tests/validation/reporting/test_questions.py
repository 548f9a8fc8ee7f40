"""Reports of studies by their commands: within their bounds, with numbers of theory, and able to fail."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from validation.__main__ import app
from validation.accuracy import catalogue
from validation.accuracy.catalogue import TOPIC
from validation.reporting.command import Done, write
from validation.reporting.findings import Finding, Study, near
from validation.reporting.plain import restored
from validation.stability.report import STUDIES as MAPPED
from validation.stability.study import Verdict

# Studies of half a second each, whose models other tests compile; the others take most of the time.
FEW = {"accuracy": ("modes_needed", "elastica"), "stability": ("stick_slip", "damped_beam")}


def asked(topic: str, folder: Path, *studies: str) -> tuple[int, dict[str, Any]]:
    chosen = [word for name in studies for word in ("--study", name)]
    done = CliRunner().invoke(app, [topic, *chosen, "--quick", "--json", "--report", str(folder)])
    return done.exit_code, json.loads(done.stdout)


def assert_maps_say_why_they_have_no_number(study: dict[str, Any]) -> None:
    """Check that each map without a number has an outcome."""
    for found in study["maps"].values():
        ended, values = np.array(found["ended"]), np.array(found["values"], dtype=object)
        assert values.shape == (len(found["y"]), len(found["x"]))
        assert np.array_equal(np.equal(values, None), ~np.isin(ended, ("finished", "event")))


# Closed forms and tables, written here a second time: study, beginning of a number's name -> value, relative tolerance.
KNOWN = {
    ("spinning", "speed of divergence without foreshortening, hub ratio 1"): (3.5160152685, 1e-6),
    ("spinup", "3 functions: peak against the exact rod"): (-0.7505230852, 4e-3),
    ("elastica", "deflection over L at which the error reaches 5 %"): (0.2144882, 1e-2),
    ("estimate", "force at the tip: largest factor"): (1.01138, 1e-2),
    ("buckling", "Euler's load, legendre, 5 functions"): (np.pi**2 / 4, 1e-8),
    ("buckling", "buckling under its weight"): (7.837347, 1e-6),
    ("buckling", "lateral buckling, 4 functions"): (4.016, 2e-4),
    ("damping", "logarithmic decrement"): (0.1259484, 1e-6),
    ("pendulum", "stiff: largest deflection"): (0.0120579, 2e-3),
    ("conditioning", "legendre: condition number with 8"): (3.8, 1e-12),
    # Exponents of convergence.
    ("convergence", "cubic splines: exponent"): (4.0, 0.7 / 4.0),
    ("convergence", "cantilever modes: exponent"): (4.0, 0.7 / 4.0),
}
AT_LEAST = {("energy", "first order: exponent"): 1.9, ("convergence", "Legendre: decades"): 0.7}


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("topic", "studies"),
    [
        ("accuracy", FEW["accuracy"]),
        ("stability", FEW["stability"]),
        *(pytest.param(topic, (), marks=SLOW) for topic in ("accuracy", "stability")),
        pytest.param("diagrams", ("square", "two_arms"), marks=SLOW),
    ],
)
def test_every_question_is_answered_within_its_bounds(topic: str, studies: tuple[str, ...], tmp_path: Path) -> None:
    code, data = asked(topic, tmp_path, *studies)
    assert data["quick"] and not data["failures"] and not data["unfinished"] and set(studies) <= set(data["studies"])
    numbers: dict[tuple[str, str], float] = {}
    for name, study in data["studies"].items():
        findings = restored(tuple[Finding, ...], study["findings"])
        # How fast a busy machine is says nothing of the answer.
        assert findings and all(one.ok for one in findings if topic != "diagrams" or "second" not in one.quantity), name
        numbers |= {(name, one.quantity): one.value for one in findings}
        if "maps" in study:
            assert re.search(r"\d", study["verdict"]), f"{name}: a verdict has figures"
            assert_maps_say_why_they_have_no_number(study)
        else:
            assert study["figures"]
    assert topic == "diagrams" or (code == 0 and data["ok"])
    for (study, what), (expected, relative) in KNOWN.items() if topic == "accuracy" else ():
        found = [value for (of, name), value in numbers.items() if of == study and name.startswith(what)]
        assert found == ([pytest.approx(expected, rel=relative)] if study in data["studies"] else []), what
    for (study, what), least in AT_LEAST.items():
        assert all(value > least for (of, name), value in numbers.items() if of == study and name.startswith(what))


@pytest.mark.parametrize(
    "study", ["spinning", "spinup", "buckling", "rods", "rods_in_motion", "damping", "conditioning"]
)
def test_beams_are_as_accurate_as_stated(study: str) -> None:
    """Against closed forms, tables and exact rods, by turns; the others take long."""
    findings = catalogue.STUDIES[study](True).findings
    assert findings and not [str(one) for one in findings if not one.ok]


def missed(quick: bool) -> Study:
    return Study("Does it fail?", "Yes.", (), (Finding("zero", 1.0, 0.0),))


def test_a_missed_bound_fails_the_command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(catalogue.STUDIES, "spinning", missed)
    judged = replace(MAPPED["stick_slip"], judge=lambda maps: Verdict("1.", "2.", missed(True).findings))
    monkeypatch.setitem(MAPPED, "stick_slip", judged)
    # One study of the atlas has a folder of its own, and leaves the whole atlas as it is.
    for topic, study, page in (
        ("accuracy", "spinning", "accuracy.md"),
        ("stability", "stick_slip", "stability/stability.md"),
    ):
        done = CliRunner().invoke(app, [topic, "--study", study, "--quick", "--report", str(tmp_path)])
        assert done.exit_code == 1 and "1 miss their bounds" in done.stdout
        assert "**missed** 1" in (tmp_path / page).read_text()


def test_a_study_that_cannot_be_done_fails_the_command_and_no_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def broken(quick: bool) -> Study:
        raise ArithmeticError("diverged")

    monkeypatch.setitem(catalogue.STUDIES, "spinning", broken)
    code, data = asked("accuracy", tmp_path, "spinning", "elastica")
    assert code == 1 and not data["ok"] and data["studies"]["elastica"]["ok"]
    assert data["failures"] == {"spinning": "ArithmeticError: diverged"}


@pytest.mark.parametrize(("found", "ok"), [(1.0, True), (1.011, False), (0.989, False), (np.nan, False)])
def test_bounds_decide_the_answer(found: float, ok: bool) -> None:
    assert near("x", found, 1.0, 0.01, "").ok is ok
    assert near("x", -found, -1.0, 0.01, "").ok is ok


def test_a_report_without_studies_is_not_a_success(tmp_path: Path) -> None:
    data = Done().head(True, False) | {"studies": {}}
    assert write(TOPIC, data, tmp_path).ok is False and (tmp_path / "accuracy.html").is_file()
