"""Figures of a beam as one types it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from symofros.studio.editor.document.figures.beam_figures import beam_figures

BEAM = {"length": 1.0, "rhoA": 1.0, "EI_y": 1.0, "EI_z": 4.0, "GJ": 1.0}


def test_a_cantilever_has_the_frequencies_of_its_two_bending_stiffnesses() -> None:
    frequencies = beam_figures(BEAM, {})["frequencies"]
    np.testing.assert_allclose(frequencies["bend_z"][0], 1.8751040687**2 / (2.0 * np.pi), rtol=1e-9)
    np.testing.assert_allclose(frequencies["bend_y"], 2.0 * np.array(frequencies["bend_z"]), rtol=1e-12)


@pytest.mark.parametrize("stated", [{"length": 1e-300}, {"rhoA": 1e-300, "EI_y": 1e300}, {"rhoA": "1/p"}])
def test_frequencies_beyond_all_numbers_are_left_out(stated: dict[str, float | str]) -> None:
    figures = beam_figures({**BEAM, **stated}, {"p": 0.0})
    json.dumps(figures, allow_nan=False)
    assert "bend_z" not in figures["frequencies"]


def test_how_far_its_theory_reaches_follows_from_the_length_alone() -> None:
    validity = beam_figures({**BEAM, "length": "2*L"}, {"L": 0.5})["validity"]
    assert [line["error"] for line in validity] == [0.01, 0.1, 0.5]
    # A force at the tip deflects it by 2/3 of slope times length; small slopes err by 16/35 of their square.
    assert validity[0]["slope"] == pytest.approx(np.sqrt(0.01 / 0.457), rel=0.01)
    assert validity[0]["deflection"] == pytest.approx(2.0 / 3.0 * validity[0]["slope"], rel=1e-12)
    assert beam_figures({**BEAM, "theory": "strain"}, {})["validity"] == []
