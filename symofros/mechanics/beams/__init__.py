"""One flexible body in its own frame: shape functions, deformation, modal integrals (docs/theory/beams.md)."""

from __future__ import annotations

from symofros.mechanics.beams.deformation import Deformation as Deformation
from symofros.mechanics.beams.deformation import deformation_of as deformation_of
from symofros.mechanics.beams.fields import Field as Field
from symofros.mechanics.beams.fields import Monomial as Monomial
from symofros.mechanics.beams.rod_shape import RodShape as RodShape
from symofros.mechanics.beams.section_law import section_law as section_law
from symofros.mechanics.beams.shape_functions import MAX_MODES as MAX_MODES
from symofros.mechanics.beams.shape_functions import FamilyError as FamilyError
from symofros.mechanics.beams.shape_functions import shapes as shapes
from symofros.mechanics.beams.strains import AXES as AXES
from symofros.mechanics.beams.strains import TURNING as TURNING
from symofros.mechanics.beams.strains import strain_functions as strain_functions
from symofros.mechanics.beams.strains import strains_of as strains_of
