"""Frequencies of a spinning cantilever, with and without foreshortening."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

import symofros as sf
from tests.reference.beams import cantilever, compiled, data, stiffness

TABLE = data("spinning_cantilever")["table"]
PUBLISHED = data("spinning_cantilever")["published_wright_delta0"]


@cache
def spinning(**changed: Any) -> sf.Model:
    """A beam at radius r on a hub whose turn is given; speeds in units of sqrt(EI/(rhoA L^4))."""
    hub = sf.RigidBody("hub", sf.Joint("turn", "revolute", prescribed=True))
    root = sf.Joint("root", "fixed", "hub", position=("r", 0, 0))
    return compiled(hub, cantilever(root, **changed), parameters=[sf.Parameter("r", 0.0)])


def frequencies(m: sf.Model, eta: float, delta: float, direction: str) -> np.ndarray:
    """Squares of the circular frequencies; the two planes don't couple in small vibrations."""
    own = [i for i, name in enumerate(m.names.q) if direction in name]
    u = np.array([0.0, eta, 0.0])
    K, M = stiffness(m, u=u, r=delta), m.mass_matrix(np.zeros(m.nq), u=u)
    return scipy.linalg.eigvalsh(K[np.ix_(own, own)], M[np.ix_(own, own)])


# What a Ritz solution with polynomials of these degrees gives: 9.8e-6 and 2.4e-7, at the highest speed.
@pytest.mark.parametrize(("modes", "tolerance"), [(8, 2e-5), (10, 5e-7)])
def test_frequencies_match_the_whole_table(modes: int, tolerance: float) -> None:
    m = spinning(bend_y=modes, bend_z=modes)
    worst = 0.0
    for row in TABLE:
        for direction, plane in (("bend_z", "flap"), ("bend_y", "chord")):
            found = np.sqrt(frequencies(m, row["eta"], row["delta"], direction)[:3])
            error = found / row[plane][:3] - 1.0
            assert np.all(error > -1e-9), row  # Ritz: from above.
            worst = max(worst, float(error.max()))
    assert tolerance / 3 < worst < tolerance  # Neither worse nor mysteriously better than the basis allows.


@pytest.mark.parametrize("eta", range(13))
def test_frequencies_match_the_published_table(eta: int) -> None:
    found = np.sqrt(frequencies(spinning(bend_y=10, bend_z=10), eta, 0.0, "bend_z")[:3])
    expected = np.array(PUBLISHED[str(eta)])
    digits = np.array([0.5e-4, 0.5e-4, 0.5e-4])
    assert np.all(np.abs(found - expected) <= digits + 2e-5 * expected)


@pytest.mark.parametrize("delta", [0.0, 1.0])
def test_softening_without_foreshortening_diverges(delta: float) -> None:
    """Softening -eta^2 M without stiffening: divergence at the first natural frequency, whatever the hub ratio."""
    m = spinning(bend_y=5, foreshortening=False, retain="all")
    critical = scipy.optimize.brentq(lambda eta: frequencies(m, eta, delta, "bend_y")[0], 3.0, 4.0)
    assert critical == pytest.approx(3.51601526850015, rel=1e-3)
    for eta in (3.0, 6.0, 12.0):
        expected = 3.51601526850015**2 - eta**2
        assert frequencies(m, eta, delta, "bend_y")[0] == pytest.approx(expected, rel=1e-5)
