"""The table of elastic theories beside the dataclass whose entries it names and the mechanics that serve it."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import pytest

import symofros as sf
from symofros.description.beams.elastic import ELASTIC, STRAINS, THEORIES
from symofros.mechanics.beams import theories


def beam(**entries: Any) -> sf.Beam:
    return sf.Beam("b", sf.Joint("clamp", "fixed"), 1.0, 1.0, **entries)


def test_every_theory_has_a_row_and_an_implementation() -> None:
    assert tuple(ELASTIC) == tuple(theories.THEORIES) == THEORIES


@pytest.mark.parametrize("theory", THEORIES)
def test_a_row_names_entries_of_a_beam(theory: str) -> None:
    row = ELASTIC[theory]
    assert set(row.lacking) <= {item.name for item in fields(sf.Beam)}
    assert set(row.directions) == set(STRAINS) - set(row.lacking)


@pytest.mark.parametrize("theory", THEORIES)
def test_entries_that_a_theory_lacks_are_refused(theory: str) -> None:
    given = {"sections": 3, "stiffness": [[float(i == j) for j in range(6)] for i in range(6)]}
    given |= {"retain": "all", "foreshortening": False}
    for item in fields(sf.Beam):
        if item.name in ELASTIC[theory].lacking:
            other = 1 if item.name in STRAINS else (0.1, 0.2) if item.name.endswith("center") else 0.5
            with pytest.raises(sf.DescriptionError, match=f"it has no entry {item.name}"):
                beam(**{"theory": theory, item.name: given.get(item.name, other)})
