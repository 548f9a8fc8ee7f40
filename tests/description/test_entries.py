"""Entries that do not exist are refused in words, by every class of a description."""

from __future__ import annotations

import re
from dataclasses import fields
from functools import partial
from typing import Any

import pytest

import symofros as sf
from tests.description.hostile.test_nonsense import NOUNS


@pytest.mark.parametrize("cls", [noun for noun in NOUNS if noun is not sf.Rotation])  # Its calls are those of makers.
def test_an_unknown_entry_is_named_with_the_nearest(cls: Any) -> None:
    entry = [field.name for field in fields(cls) if field.init][-1]
    with pytest.raises(sf.DescriptionError, match=f"no entry '{entry}x'") as raised:
        cls(**{f"{entry}x": 1})
    problem = raised.value.problem
    assert entry in problem.rule and problem.found and problem.remedy


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        *(({entry: 1e6}, rf"Beam 'b': no entry '{entry}'(.|\n)*GA_y") for entry in ("GA", "kGA")),
        (
            {"bend_y": 1, "EI_z": 1.0, "family": "user", "shapes": {"bend_y": ("xi^2",), "stretch": ("xi",)}},
            r"beam 'b': shapes for stretch(.|\n)*theory: strain",
        ),
        ({"bend_y": 1, "EI_z": 1.0, "shapes": {"bend_y": ("xi^2",)}}, "beam 'b': shapes with family 'spline'"),
        ({"stations": (0.0, 0.5)}, "beam 'b': stations of section forces on a rigid beam"),
    ],
)
def test_entries_of_a_beam_that_nothing_would_use_are_refused(entries: dict[str, Any], words: str) -> None:
    with pytest.raises(sf.DescriptionError, match=words):
        sf.Beam("b", sf.Joint("q", "fixed"), 1.0, 1.0, **entries)


@pytest.mark.parametrize("cls", [partial(sf.Frame, "f"), sf.BeamLoad])
@pytest.mark.parametrize("at", ["L/2", float("nan"), 1.5])
def test_a_station_is_a_number_from_root_to_tip(cls: Any, at: Any) -> None:
    with pytest.raises(sf.DescriptionError, match="off the beam"):
        cls(at=at)


def test_positional_entries_of_beams_keep_their_order() -> None:
    beam = sf.Beam("b", sf.Joint("q", "fixed"), 1.0, 2.0, 3.0, 4.0, 5.0, 0.6, 0.7, 0.8, 1, 2, 3, "legendre")
    assert (beam.length, beam.rhoA, beam.EI_z, beam.EI_y, beam.GJ) == (1.0, 2.0, 3.0, 4.0, 5.0)
    assert (beam.rhoJ, beam.rhoI_y, beam.rhoI_z) == (0.6, 0.7, 0.8)
    assert (beam.bend_y, beam.bend_z, beam.twist, beam.family) == (1, 2, 3, "legendre")


@pytest.mark.parametrize("theory", ["second_order", "strain"])
def test_loads_along_sections_are_taken_by_theories_of_any_bending_alone(theory: Any) -> None:
    given: Any = {"bend_y": 1, "EI_z": 1.0, "theory": theory, "loads": (sf.BeamLoad((1.0, 0.0, 0.0), axes="section"),)}
    if theory == "strain":
        assert sf.Beam("rod", sf.Joint("q", "revolute"), 1.0, 1.0, **given).loads
        return
    with pytest.raises(sf.DescriptionError, match=r"along the axes of the sections[\s\S]*state theory: strain"):
        sf.Beam("rod", sf.Joint("q", "revolute"), 1.0, 1.0, **given)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: sf.System("s", (), contacts=()), "connections=(...) has contacts"),  # type: ignore[call-arg]
        (lambda: sf.System("s", (), closures=()), "constraints=(...) has all"),  # type: ignore[call-arg]
        (lambda: sf.Joint("q", "revolute", friction=1.0), "elements=(sf.Friction"),  # type: ignore[call-arg]
        (lambda: sf.Joint("q", "revolute", damping=1.0), "elements=(sf.Damper"),  # type: ignore[call-arg]
        (lambda: sf.Joint("q", "revolute", upper=1.0), "limits=sf.Limits"),  # type: ignore[call-arg]
    ],
)
def test_misplaced_entries_of_files_and_other_programs_lead_to_their_place(make: Any, said: str) -> None:
    """The nearest entry was 'constraints' of contacts, 'rotation' of friction."""
    with pytest.raises(sf.DescriptionError, match=re.escape(said)):
        make()
