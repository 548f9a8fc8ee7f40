"""Exudyn's elements moved by our speeds: they agree, at a known rate, and a wrong term of the map is found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import reference_models
import symofros as sf
from tests.models import sampled
from tests.validation.adapters.lagrangian.test_engine import beam
from tests.validation.subjects import UNIT
from validation.adapters.exudyn.mapped import CUBIC, LINEAR, extrapolated
from validation.check import ModelResult, Settings, check
from validation.contract.interface import Subject
from validation.contract.quantities import FRAME_QUANTITIES, TREE_QUANTITIES
from validation.mechanics import elastic
from validation.mechanics.elastic import Curve, ElasticBeam
from validation.mechanics.geometry import Array

NAME = "exudyn-beams"
SETTINGS = Settings(states=20, engines=(NAME,))
OFFERED = TREE_QUANTITIES - {"potential_energy", "frame_jacobian_rate"}


def checked(system: sf.System) -> dict[str, Any]:
    result = check(Subject(system.name, system), SETTINGS)
    assert result.ok, [row for row in result.comparisons if not row.ok]
    return {row.quantity: row for row in result.comparisons if row.engine == NAME}


def disagreeing(result: ModelResult) -> set[str]:
    return {row.quantity for row in result.comparisons if row.status == "disagree"}


@pytest.mark.parametrize(
    "name",
    sampled(
        ("planar_robot", "spinning_beam", "flexible_pendulum", "free_boom", "flexible_slider_crank"),
        ("spinning_beam", "flexible_slider_crank"),
    ),
)
def test_elements_that_move_as_our_beams_have_their_mechanics(name: str) -> None:
    rows = checked(reference_models.MODELS[name])
    assert {quantity for quantity, row in rows.items() if row.status == "agree"} >= OFFERED
    assert all(rows[quantity].error < 1e-13 for quantity in FRAME_QUANTITIES & OFFERED)
    if not any(isinstance(b, sf.Beam) and b.rotary_inertia for b in reference_models.MODELS[name].bodies):
        assert all(row.error is None or row.error < 1e-8 for row in rows.values())


@pytest.mark.parametrize(
    "kind", sampled(("free", "ball", "universal", "cylindrical", "planar", "screw"), ("free", "universal", "screw"))
)
def test_a_beam_on_every_kind_of_joint_with_a_body_at_its_tip(kind: str) -> None:
    joint = sf.Joint("j", kind, position=(0.1, 0.2, 0.3), axis=(1, 2, 2), pitch=0.2)  # type: ignore[arg-type]
    load = sf.RigidBody("load", sf.Joint("elbow", "revolute", "b", "tip", axis=(0, 1, 0)), UNIT)
    rows = checked(sf.System(kind, [beam("b", joint), load]))
    assert rows["mass_matrix"].error < 1e-12 and rows["bias"].error < 1e-11


def test_extrapolation_removes_the_powers_that_it_is_told() -> None:
    h = 0.5 ** np.arange(5)
    for powers in (CUBIC, LINEAR):
        values = [np.array(3.0 + sum((k + 1) * step**power for k, power in enumerate(powers))) for step in h]
        assert extrapolated(values, powers) == pytest.approx(3.0, abs=1e-13)


def spinning() -> Subject:
    return Subject("spinning_beam", reference_models.MODELS["spinning_beam"])


def test_a_wrong_foreshortening_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = ElasticBeam._foreshortening
    monkeypatch.setattr(ElasticBeam, "_foreshortening", lambda self, x: right(self, x) * 1.001)
    assert {"mass_matrix", "bias", "frame_pose"} <= disagreeing(check(spinning(), SETTINGS))


def test_a_wrong_sign_in_the_rate_of_the_map_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of q. H q., which M does not contain."""
    right = ElasticBeam._curved

    def turned(self: ElasticBeam, linear: Array, H: Array, along: Array, q: Array, v: Array) -> Curve:
        curve = right(self, linear, H, along, q, v)
        return replace(curve, bend=-curve.bend)

    monkeypatch.setattr(elastic.ElasticBeam, "_curved", turned)
    wrong = disagreeing(check(spinning(), SETTINGS))
    assert {"bias", "forward_dynamics", "frame_acceleration"} <= wrong
    assert not {"mass_matrix", "frame_velocity", "frame_jacobian"} & wrong
