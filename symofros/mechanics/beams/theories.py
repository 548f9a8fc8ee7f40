"""The theories of elastic beams: one row a theory, by its name in the description (`description/beams/elastic.py`)."""

from __future__ import annotations

from symofros.description.beams.beam import Beam
from symofros.mechanics.beams.second_order.theory import SecondOrderTheory
from symofros.mechanics.beams.strain.theory import StrainTheory
from symofros.mechanics.beams.theory import BeamTheory

THEORIES: dict[str, type[BeamTheory]] = {
    "second_order": SecondOrderTheory,
    "strain": StrainTheory,
}


def theory_of(beam: Beam) -> BeamTheory:
    """A beam by the theory that it states."""
    return THEORIES[beam.theory](beam)
