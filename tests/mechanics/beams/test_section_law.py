"""The law of a rod's sections by stiffnesses and centres, against the matrix of all six strains in NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from symofros.description.beams.sections import Section
from symofros.mechanics.beams.strain.section_law import section_law
from tests.mechanics.beams.rods import rod

# Zero and one, which sums and products leave out, and others.
STIFFNESS = st.sampled_from([1.0, 0.5, 2.0])
CENTER = st.tuples(*2 * [st.sampled_from([0.0, 1.0, -1.0, 0.3])])
TURNING, FUNCTIONS = {0, 1, 2}, {3: "stretch", 4: "shear_y", 5: "shear_z"}


@given(
    stated=st.fixed_dictionaries(
        dict.fromkeys(("EI_y", "EI_z", "GJ", "EA", "GA_y", "GA_z"), STIFFNESS)
        | dict.fromkeys(("tension_center", "shear_center"), CENTER)
        | {"EI_yz": st.sampled_from([0.0, 0.1])}
    ),
    more=st.sets(st.sampled_from([*FUNCTIONS])),
)
def test_strains_without_functions_leave_the_least_energy(stated: dict[str, Any], more: set[int]) -> None:
    """What is left is Schur's complement, and they follow the others as it says."""
    functions = {name: int(k in more) for k, name in FUNCTIONS.items()}
    law = section_law(rod((1, 1, 1), **functions, **stated), TURNING | more)
    K = np.roll(Section(rhoA=1.0, rhoI_y=0.1, rhoI_z=0.1, **stated).stiffness_matrix(), (3, 3), (0, 1))
    counted, free = sorted(TURNING | more), sorted(FUNCTIONS.keys() - more)
    follow = -np.linalg.solve(K[np.ix_(free, free)], K[np.ix_(free, counted)])
    left = K[np.ix_(counted, counted)] + K[np.ix_(counted, free)] @ follow
    found = np.array([[law.following.get((k, b), 0.0) for b in counted] for k in free], dtype=float)
    assert found.ravel() == pytest.approx(follow.ravel(), rel=1e-12, abs=1e-12)
    twice = np.array([[law.stiffness.get((a, b), 0.0) for b in counted] for a in counted], dtype=float)
    assert twice == pytest.approx(np.triu(left) + np.triu(left, 1), rel=1e-12, abs=1e-12)
