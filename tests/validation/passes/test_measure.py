"""Leaving a pass out changes what is generated and not what is computed; the generator is whole again afterwards."""

from __future__ import annotations

from dataclasses import asdict

import pytest

import symofros as sf
from reference_models import MODELS
from symofros.tools import ABLATIONS, Ablation, count_program
from validation.passes.measure import AGAIN, ALL, APART, Measured, ablated
from validation.passes.measure import MODELS as MEASURED
from validation.passes.report import compose
from validation.reporting.record import Table

# A model in which the pass has something to do.
WHERE = {"staging": "planar_robot", "rounding noise": "rx90", "constant factors": "planar_robot"}


def operations(name: str) -> int:
    return count_program(sf.program_of(MODELS[name], ("dynamics",)))["dynamics", ""].total


def text(name: str, options: sf.Options) -> str:
    path, _ = sf.compile_library(MODELS[name], options)
    return path.with_suffix(".c").read_text(encoding="utf-8") + path.name


LARGE = ("packs", "pieces")  # Passes that show in long chains.


@pytest.mark.parametrize(
    "one",
    [pytest.param(one, marks=[pytest.mark.slow] if one.name in LARGE else []) for one in ABLATIONS],
    ids=lambda one: one.name,
)
def test_a_pass_that_is_left_out_shows(one: Ablation) -> None:
    name = WHERE.get(one.name, "chain22" if one.name in LARGE else "puma560")
    plain = sf.Options(("dynamics",), batch="loop")
    whole, before = text(name, plain), operations(name)
    with one.without():
        assert operations(name) >= before
        assert text(name, one.options(plain)) != whole
    assert operations(name) == before
    assert text(name, plain) == whole


@pytest.mark.slow  # In every run: each pass that is left out shows.
def test_a_model_is_measured_without_each(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(MEASURED, "small", lambda: MODELS["rx90"])
    rows = list(ablated("small", repeats=3))
    assert [row.without for row in rows] == [ALL, AGAIN, *(one.name for one in ABLATIONS), APART]
    assert all(row.off <= 1e-11 and row.minimum > 0.0 for row in rows)
    assert rows[0].off == rows[1].off == 0.0


def test_gains_are_relative_to_all_passes() -> None:
    base = Measured("m", 2, ALL, 100, 1024, 0.1, 9.0, 10.0, 0.0)
    other = Measured("m", 2, "x", 150, 2048, 0.2, 11.0, 12.0, 0.0)
    report = compose({"rows": [asdict(base), asdict(other)]})
    (section,) = (section for section in report.sections if section.title == "m, 2 degrees of freedom")
    (table,) = (block for block in section.blocks if isinstance(block, Table))
    assert table.rows == (
        ("all passes", "100", "", "9, 10", "", "1", "0.10"),
        ("x", "150", "+50.0%", "11, 12", "+20%", "2", "0.20"),
    )
    assert report.facts[0].value == "1.2×"
