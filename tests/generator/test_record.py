"""What a model knows of itself is what its description says."""

from __future__ import annotations

import math

import numpy as np
import pytest

import symofros as sf

LIMITS = (None, sf.Limits(), sf.Limits(lower=-0.3), sf.Limits(upper=0.4), sf.Limits(lower=0.1, upper=0.2))


def bead(i: int, kind: str, limits: sf.Limits | None) -> sf.RigidBody:
    """A body on a joint of one coordinate."""
    return sf.RigidBody(f"b{i}", sf.Joint(f"q{i}", kind, limits=limits), sf.Inertia(1.0))  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["prismatic", "revolute"])
def test_each_limit_is_kept_whether_or_not_the_other_is_stated(kind: str) -> None:
    """A lower limit that was left out where it was stated was seen by no test."""
    system = sf.System("beads", tuple(bead(i, kind, limits) for i, limits in enumerate(LIMITS)))
    model = sf.compile(system, sf.Options(functions=("mass_matrix",), backend="interpreter"))
    assert model.record.q_lower == (-math.inf, -math.inf, -0.3, -math.inf, 0.1)
    assert model.record.q_upper == (math.inf, math.inf, math.inf, 0.4, 0.2)
    q = np.array([model.random_state(np.random.default_rng(seed))[0] for seed in range(200)])
    assert q[:, 2].min() >= -0.3 and q[:, 3].max() <= 0.4
    assert 0.1 <= q[:, 4].min() < 0.11 < 0.19 < q[:, 4].max() <= 0.2
