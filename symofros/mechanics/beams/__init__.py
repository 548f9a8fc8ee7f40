"""Elastic beams, by theory: shape functions, fields, equations, shape (docs/theory/beams.md, rods.md)."""

from __future__ import annotations

from symofros.mechanics.beams.shape_functions import MAX_MODES as MAX_MODES
from symofros.mechanics.beams.shape_functions import FamilyError as FamilyError
from symofros.mechanics.beams.strain.section_law import section_law as section_law
from symofros.mechanics.beams.strain.strains import AXES as AXES
from symofros.mechanics.beams.strain.strains import TURNING as TURNING
from symofros.mechanics.beams.theories import THEORIES as THEORIES
from symofros.mechanics.beams.theories import theory_of as theory_of
from symofros.mechanics.beams.theory import BeamShape as BeamShape
