"""What a rod's section resists, by the strains that have functions (docs/theory/rods.md, section 2).

A rod bends and twists by its functions alone. Of stretch and shear, those without functions do not stay zero: they
follow the others so that no force acts on them, as the axis need not go through the centres of the section.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import reduce

from symofros.description.beams.beam import Beam
from symofros.description.beams.elastic import MATRIX_ORDER
from symofros.description.values import Term, Value
from symofros.mechanics.beams.strain.strains import TURNING

_STRAINS = len(MATRIX_ORDER)
Coefficients = dict[tuple[int, int], Value]


@dataclass(frozen=True)
class SectionLaw:
    """Strain energy per length of the strains with functions, and the strains that follow them.

    Strains are numbered as in `strains.AXES`: twist rate, curvatures about y and z, stretch, shears along y and z.

    Attributes:
        stiffness: Coefficient of each product of two strains a <= b in twice the energy, once for both orders.
        following: Of each strain without functions, by each that it follows, its change per unit of that.
    """

    stiffness: Coefficients
    following: Coefficients


def section_law(beam: Beam, counted: Collection[int]) -> SectionLaw:
    """The law of a rod's sections."""
    free = [k for k in range(TURNING, _STRAINS) if k not in counted]
    K = reduce(_swept, free, _by_matrix(beam)) if beam.stiffness else _by_centers(beam, counted)
    kept = sorted(counted)
    stiffness = {
        (a, b): value if a == b else _doubled(value)
        for a in kept
        for b in kept
        if a <= b and (value := K.get((a, b), 0.0)) != 0.0
    }
    following = {(k, b): _negative(value) for k in free for b in kept if (value := K.get((k, b), 0.0)) != 0.0}
    return SectionLaw(stiffness, following)


def _by_matrix(beam: Beam) -> Coefficients:
    """A stated matrix, its rows and columns in our order of the strains."""
    order = [(i + TURNING) % _STRAINS for i in range(_STRAINS)]
    return {
        (order[i], order[j]): value
        for i, row in enumerate(beam.stiffness)
        for j, value in enumerate(row)
        if value != 0.0
    }


def _by_centers(beam: Beam, counted: Collection[int]) -> Coefficients:
    """Stiffness by entries about the centres (2a); of stretch and shear without functions what `_swept` leaves.

    Rows of these are the strains at the centres by those of the axis, which are zero: they need no stiffness.
    """
    (y_t, z_t), (y_s, z_s) = beam.tension_center, beam.shear_center
    at_centers: tuple[tuple[int, dict[int, Value], Value], ...] = (
        (3, {1: z_t, 2: _negative(y_t)}, beam.EA),
        (4, {0: _negative(z_s)}, beam.GA_y),
        (5, {0: y_s}, beam.GA_z),
    )
    K: Coefficients = {(0, 0): beam.GJ, (1, 1): beam.EI_y, (2, 2): beam.EI_z}
    K[1, 2] = K[2, 1] = _negative(beam.EI_yz)
    for k, arms, stiffness in at_centers:
        if k not in counted:
            K |= {(k, b): arm for b, arm in arms.items()}
            continue
        row: dict[int, Value] = {k: 1.0, **arms}
        for a, first in row.items():
            for b, second in row.items():
                more = _product(_product(stiffness, first), second)
                K[a, b] = _sum(K.get((a, b), 0.0), more)
    return K


def _swept(K: Coefficients, k: int) -> Coefficients:
    """A matrix after one step of elimination: Schur's complement; row k is what strain k follows by, less its sign."""
    pivot = K[k, k]
    row = {j: (Term(value) / Term(pivot)).value for (i, j), value in K.items() if i == k and j != k}
    swept = {(i, j): value for (i, j), value in K.items() if k not in (i, j)}
    for (i, column), value in K.items():
        if column != k or i == k:
            continue
        for j, share in row.items():
            swept[i, j] = _sum(swept.get((i, j), 0.0), _negative(_product(value, share)))
    return swept | {(k, j): share for j, share in row.items()}


def _product(a: Value, b: Value) -> Value:
    if 0.0 in (a, b):
        return 0.0
    return b if a == 1.0 else a if b == 1.0 else (Term(a) * Term(b)).value


def _sum(a: Value, b: Value) -> Value:
    return b if a == 0.0 else a if b == 0.0 else (Term(a) + Term(b)).value


def _negative(a: Value) -> Value:
    return (Term(0.0) - Term(a)).value if a != 0.0 else 0.0


def _doubled(a: Value) -> Value:
    return (Term(2.0) * Term(a)).value
