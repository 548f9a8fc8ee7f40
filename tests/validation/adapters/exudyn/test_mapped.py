"""Exudyn's elements moved by our speeds: they agree, at a known rate, and a wrong term of the map is found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import reference_models
import symofros as sf
from tests.mechanics.beams.rods import GRAVITY, HUB, STIFF, rod
from tests.models import sampled
from tests.validation.adapters.lagrangian.test_engine import beam
from tests.validation.subjects import UNIT
from validation.adapters.exudyn import mapped
from validation.checking import ModelResult, Settings, check
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import FRAME_QUANTITIES, TREE_QUANTITIES
from validation.inputs.sampling import sample
from validation.mechanics import elastic
from validation.mechanics.assembly import assemble
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
        ("flexible_pendulum",),
    ),
)
def test_elements_that_move_as_our_beams_have_their_mechanics(name: str) -> None:
    rows = checked(reference_models.MODELS[name])
    assert {quantity for quantity, row in rows.items() if row.status == "agree"} >= OFFERED
    assert all(rows[quantity].error < 1e-13 for quantity in FRAME_QUANTITIES & OFFERED)
    if not any(isinstance(b, sf.Beam) and b.rotary_inertia for b in reference_models.MODELS[name].bodies):
        assert all(rows[quantity].error < 1e-8 for quantity in OFFERED)


RODS: dict[str, sf.Beam] = {
    "in a plane": rod((3, 0, 0), HUB, rhoJ=0.0, sections=8),
    "in space, with rotary inertia": rod((2, 1, 1), HUB, rotary_inertia=True, sections=8),
    "of splines, tapered": rod((4, 0, 0), HUB, family="spline", rhoA="2 + x", sections=9),
    "stretched and sheared": rod((2, 0, 0), HUB, stretch=1, shear_y=2, sections=7, **STIFF),
    "curved and twisted without stress": rod((1, 1, 1), HUB, curvature_y=0.3, twist_rate="0.2*x", sections=8),
}


@pytest.mark.parametrize("name", RODS)
def test_rods_have_the_mechanics_and_the_elastic_forces_of_exact_elements(name: str) -> None:
    subject = Subject("s", sf.System("s", (RODS[name],), gravity=GRAVITY))
    engine = mapped.build(subject)
    assert not isinstance(engine, Unsupported)
    states = sample(assemble(subject.system), 0, 12)
    m = sf.compile(subject.system, sf.Options(("mass_matrix", "bias", "generalized_force"), backend="interpreter"))
    for right, ours in ((engine.mass_matrix, m.mass_matrix(states.q)), (engine.bias, m.bias(states.q, states.v))):
        assert np.abs(right(states) - ours).max() < mapped.EXTRAPOLATED * np.abs(ours).max()
    (one,) = engine.elements
    forces = m.generalized_force(states.q, 0 * states.v, ())[:, one.v]
    for elastic_forces in one.strain(states.q[:, one.q]):
        assert np.abs(elastic_forces.limit() - forces).max() < 1e-11 * np.abs(forces).max()


def test_a_rod_of_another_stiffness_is_found() -> None:
    system = sf.System("s", (rod((2, 0, 0), HUB, rhoJ=0.0, sections=7),))
    other = replace(system, bodies=(replace(system.body("rod"), EI_z=3.00001),))
    factories = {NAME: lambda subject: mapped.build(replace(subject, system=other))}
    assert disagreeing(check(Subject("s", system), SETTINGS, factories)) == {"strain_forces"}


@pytest.mark.parametrize("kind", sampled(("free", "ball", "universal", "cylindrical", "planar", "screw"), ("screw",)))
def test_a_beam_with_a_tip_body_on_every_kind_of_joint_agrees(kind: str) -> None:
    joint = sf.Joint("j", kind, position=(0.1, 0.2, 0.3), axis=(1, 2, 2), pitch=0.2)  # type: ignore[arg-type]
    load = sf.RigidBody("load", sf.Joint("elbow", "revolute", "b", "tip", axis=(0, 1, 0)), UNIT)
    rows = checked(sf.System(kind, [beam("b", joint), load]))
    assert rows["mass_matrix"].error < 1e-12 and rows["bias"].error < 1e-11


def test_rates_and_orders_are_the_derived_ones() -> None:
    """In one plane cables differ by the third power of the deflection, and converge with the fourth of their length."""
    rows = checked(reference_models.MODELS["spinning_beam"])
    assert rows["strain_order"].extra["power"] == pytest.approx(3.0, abs=0.02)
    assert "strain of sections of 'beam' by nothing resolved" in rows["strain_order"].note
    assert "mass of 'beam' 4.00 of 4" in rows["mesh_rate"].note
    assert "strain of sections of 'beam' 2.00 of 2" in rows["mesh_rate"].note


@pytest.mark.slow  # In every run: uniform beams, and rotary inertia by Lagrange's equations.
def test_a_damped_tapered_beam_in_space_agrees_with_exudyn() -> None:
    """What is of second order in our rotary inertia differs by the second power, elastic forces by the third."""
    stated = {"EI_z": "3*(1 - x/3)^3", "damping": 0.01, "rotary_inertia": True, "rhoI_y": 0.02, "rhoI_z": 0.03}
    rows = checked(sf.System("tapered", [beam("b", sf.Joint("j", "revolute", axis=(1, 2, 2)), **stated)]))
    assert rows["strain_order"].extra["power"] == pytest.approx(3.0, abs=0.05)
    assert rows["rotary_order"].extra["power"] == pytest.approx(2.0, abs=0.05)
    assert rows["strain_damping"].error < 1e-10


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


@pytest.mark.parametrize(
    ("change", "quantity"),
    [
        ({"GJ": 1.501}, "strain_order"),
        ({"EI_y": 5.005}, "strain_order"),
        ({"damping": 0.01001}, "strain_damping"),
        ({"rhoI_y": 0.0}, "rotary_order"),
    ],
)
def test_another_beam_is_found(change: dict[str, Any], quantity: str) -> None:
    stated = {"damping": 0.01, "rotary_inertia": True, "rhoI_y": 0.02, "rhoI_z": 0.03}
    system = sf.System("s", [beam("b", sf.Joint("j", "revolute", axis=(1, 2, 2)), **stated)])
    other = replace(system, bodies=(replace(system.body("b"), **change),))
    factories = {NAME: lambda subject: mapped.build(replace(subject, system=other))}
    assert quantity in disagreeing(check(Subject("s", system), SETTINGS, factories))


@pytest.mark.slow
def test_slopes_that_do_not_belong_to_the_places_lower_the_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    right = ElasticBeam.tangent

    def wrong(self: ElasticBeam, x: Array, q: Array, v: Array) -> Curve:
        curve = right(self, x, q, v)
        return replace(curve, partial=1.001 * curve.partial)

    monkeypatch.setattr(ElasticBeam, "tangent", wrong)
    assert {"mesh_rate", "mass_matrix"} <= disagreeing(check(spinning(), SETTINGS))
