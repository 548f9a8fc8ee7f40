"""Bodies without mass: how M loses its rank, and when it does not."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf


def condition(bodies: list[sf.RigidBody], q: list[float]) -> float:
    m = sf.compile(sf.System("s", bodies), sf.Options(functions=("mass_matrix",), backend="interpreter"))
    return float(np.linalg.cond(m.mass_matrix(q)))


@pytest.mark.parametrize(
    ("mass", "wanted"),
    [
        (1.0, 23.59272287156066),
        (1e-3, 1010.9357044585266),
        (1e-6, 1000010.90529664),
        (1e-9, 1000000010.9052663),
    ],
)
def test_a_leaf_that_gets_lighter(mass: float, wanted: float) -> None:
    """Two uniform rods of a metre, bent by 0.7 rad: the condition of M is 1/m, and 5 + 6 c + 9/4 c^2 more (c = cos)."""
    first = sf.Inertia(1.0, (0.5, 0, 0), (0, 1 / 12, 1 / 12))
    second = sf.Inertia(mass, (0.5, 0, 0), (0, mass / 12, mass / 12))
    bodies = [
        sf.RigidBody("a", sf.Joint("q1", "revolute"), first, (sf.Frame("e", (1, 0, 0)),)),
        sf.RigidBody("b", sf.Joint("q2", "revolute", "a", "e"), second),
    ]
    found, c = condition(bodies, [0.3, 0.7]), np.cos(0.7)
    # M carries 1e-16 of its largest entry, which its smallest eigenvalue feels by as much as the condition says.
    assert found == pytest.approx(wanted, rel=max(1e-12, 1e-15 * wanted))
    assert found == pytest.approx(1 / mass + 5 + 6 * c + 2.25 * c**2, rel=max(mass, 1e-6))


@pytest.mark.parametrize(
    ("degrees", "wanted"),
    [
        (90.0, 1.0),
        (10.0, 130.64609564385998),
        (1.0, 13130.558738437152),
        (0.1, 1313121.873389643),
    ],
)
def test_a_massless_cross(degrees: float, wanted: float) -> None:
    """Between two hinges at an angle, of a body like a ball: (1 + |cos|) / (1 - |cos|)."""
    angle = np.radians(degrees)
    bodies = [
        sf.RigidBody("cross", sf.Joint("q1", "revolute", axis=(0, 0, 1))),
        sf.RigidBody(
            "ball",
            sf.Joint("q2", "revolute", "cross", axis=(np.sin(angle), 0, np.cos(angle))),
            sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)),
        ),
    ]
    found, c = condition(bodies, [0.4, -0.3]), np.cos(angle)
    assert found == pytest.approx(wanted, rel=max(1e-12, 1e-15 * wanted))
    assert found == pytest.approx((1 + c) / (1 - c), rel=max(1e-12, 1e-15 * wanted))


def test_axes_that_align_are_refused() -> None:
    bodies = [
        sf.RigidBody("cross", sf.Joint("q1", "revolute", axis=(0, 0, 1))),
        sf.RigidBody(
            "ball", sf.Joint("q2", "revolute", "cross", axis=(0, 0, 1)), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))
        ),
    ]
    m = sf.compile(sf.System("s", bodies), sf.Options(backend="interpreter"))
    assert np.linalg.matrix_rank(m.mass_matrix([0.4, -0.3])) == 1
    with pytest.raises(sf.DescriptionError, match="speed 'q1' moves nothing that those after it do not move alike"):
        m.forward_dynamics([0.4, -0.3], [1.0, 1.0], [])
