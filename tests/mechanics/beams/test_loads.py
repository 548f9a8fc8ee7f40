"""Loads along a beam against the power of the same loads on the oracle's sections."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.mechanics.beams.cases import FREE, GRAVITY, L, pair, six
from validation.adapters.lagrangian.beam import Line
from validation.adapters.lagrangian.tree import Lagrangian

TOLERANCE = 1e-13
FORCES: dict[str, tuple[sf.BeamLoad, Line]] = {
    "at the tip": (sf.BeamLoad((1.0, -2.0, 0.5), at=1.0), Line(lambda x: (1.0, -2.0, 0.5), at=L)),
    "within, in the world": (
        sf.BeamLoad((1.0, -2.0, 0.5), at=0.4, axes="world"),
        Line(lambda x: (1.0, -2.0, 0.5), at=0.4 * L, axes="world"),
    ),
    "spread": (sf.BeamLoad(("p*x", "-2", "exp(-x)")), Line(lambda x: (3 * x, -2.0, np.exp(-x)))),
    "spread, in the world": (
        sf.BeamLoad(("1 + x", 0, "p"), axes="world"),
        Line(lambda x: (1 + x, 0.0, 3.0), axes="world"),
    ),
}
TORQUES: dict[str, tuple[sf.BeamLoad, Line]] = {
    "a moment at the tip": (
        sf.BeamLoad(torque=(1.0, -2.0, 0.5), at=1.0),
        Line(lambda x: (0, 0, 0), lambda x: (1.0, -2.0, 0.5), L),
    ),
    "a moment within, in the world": (
        sf.BeamLoad(torque=("p", 0, "-1"), at=0.4, axes="world"),
        Line(lambda x: (0, 0, 0), lambda x: (3.0, 0.0, -1.0), 0.4 * L, "world"),
    ),
    "a spread moment, in the world": (
        sf.BeamLoad(torque=("x", "p", "-1"), axes="world"),
        Line(lambda x: (0, 0, 0), lambda x: (x, 3.0, -1.0), axes="world"),
    ),
}

ALL = FORCES | TORQUES


def both(load: sf.BeamLoad, line: Line, retain: Any = "all") -> tuple[sf.Model, Lagrangian]:
    beam, node = pair("beam", FREE, -1, (6, six), (2, 2, 2))
    beam = replace(beam, loads=(load,), retain=retain)
    stated = sf.System("s", [beam], [sf.Parameter("p", 3.0)], gravity=GRAVITY)
    model = sf.compile(stated, sf.Options(("generalized_force",), backend="interpreter"))
    return model, Lagrangian((replace(node, body=replace(node.body, loads=(line,))),), GRAVITY)  # type: ignore[arg-type]


def difference(model: sf.Model, oracle: Lagrangian, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    return model.generalized_force(q, v, ()) - oracle(q, v).Q


@pytest.mark.parametrize("case", [*FORCES, *TORQUES])
def test_loads_are_exact_if_everything_is_kept(case: str, rng: np.random.Generator) -> None:
    model, oracle = both(*ALL[case])
    q, v = 0.3 * rng.standard_normal(model.nq), rng.standard_normal(model.nv)
    error = np.linalg.norm(difference(model, oracle, q, v)) / np.linalg.norm(oracle(q, v).Q)
    assert error < TOLERANCE


@pytest.mark.parametrize("case", [*FORCES, *TORQUES])
def test_truncated_terms_are_of_second_order(case: str, rng: np.random.Generator) -> None:
    model, oracle = both(*ALL[case], "first_order")
    q, v = rng.standard_normal((2, model.nq))
    elastic = np.arange(model.nq) >= 6
    errors = [
        np.linalg.norm(difference(model, oracle, *(np.where(elastic, scale * x, x) for x in (q, v))))
        for scale in (2.0**-6, 2.0**-7)
    ]
    assert np.log2(errors[0] / errors[1]) >= 1.9
