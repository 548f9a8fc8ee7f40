"""Exudyn's floating-frame body against our beam, term by term; its nonlinear beams against closed forms."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from validation.adapters import exudyn_frf
from validation.assembly import assemble
from validation.compare import compute, state_errors, typical_scales
from validation.interface import States, Subject, Unsupported
from validation.quantities import QUANTITIES
from validation.sampling import sample

FREE = sf.Joint("root", "free", position=(0.1, 0.2, 0.3), rotation=sf.Rotation.rpy(0.1, 0.2, 0.3))
PLAIN: dict[str, Any] = {"rhoA": 1.3, "EI_z": 30.0, "EI_y": 40.0, "bend_y": 2, "bend_z": 3, "rhoJ": 0.02}

BEAMS: dict[str, dict[str, Any]] = {
    "one plane": {"bend_z": 0, "EI_y": 0.0},
    "two planes, damped": {"damping": 0.01},
    "an angle among the coordinates": {"family": "hermite", "bend_z": 2},
    "vibration modes": {"family": "clamped_free"},
    "tapered": {"rhoA": "1.5 - x/5", "EI_z": "30*(1 - x/4)^3", "family": "legendre"},
}


def floating(**changed: Any) -> Subject:
    """A thin beam that floats freely, as classical floating frames have it unless changed."""
    classical = {"foreshortening": False, "retain": "all"}
    beam = sf.Beam("b", FREE, 1.7, **(PLAIN | classical | changed))
    return Subject("floating", sf.System("floating", [beam], gravity=(1.0, 2.0, -9.0)))


def ours(subject: Subject) -> Any:
    functions = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "inverse_dynamics", "forward_dynamics")
    return sf.compile(subject.system, sf.Options(functions, backend="interpreter"))


def states_of(subject: Subject) -> States:
    return sample(assemble(subject.system), 0, 20)


def engine_of(subject: Subject, **options: bool) -> exudyn_frf.FloatingFrameEngine:
    engine = exudyn_frf.build(subject, **options)
    assert not isinstance(engine, Unsupported), engine
    return engine


@pytest.mark.parametrize("changed", BEAMS.values(), ids=list(BEAMS))
def test_floating_frame_term_by_term(changed: dict[str, Any]) -> None:
    """Mass matrix, quadratic velocity terms and weight, strain and damping."""
    subject = floating(**changed)
    states, model, engine = states_of(subject), ours(subject), engine_of(subject)
    pairs = {
        "mass_matrix": model.mass_matrix(states.q),
        "bias": model.bias(states.q, states.v),
        "gravity": model.bias(states.q, 0 * states.v),
        "generalized_force": model.generalized_force(states.q, states.v, states.u),
        "kinetic_energy": model.kinetic_energy(states.q, states.v),
        "inverse_dynamics": model.inverse_dynamics(states.q, states.v, states.a),
        "forward_dynamics": model.forward_dynamics(states.q, states.v, states.u),
    }
    scales = typical_scales(engine, states)
    for name, expected in pairs.items():
        quantity = QUANTITIES[name]
        errors = state_errors(quantity, compute(engine, quantity, states), expected, scales)
        assert errors.max() < quantity.tolerance, name


def test_foreshortening_and_first_order_show() -> None:
    """What the floating frame has not is seen in the comparison, so agreement above means something."""
    subject = floating()
    states, engine = states_of(subject), engine_of(subject)
    for changed in ({"foreshortening": True}, {"retain": "zeroth_order"}):
        expected = ours(floating(**changed)).bias(states.q, states.v)
        errors = state_errors(QUANTITIES["bias"], engine.bias(states), expected, typical_scales(engine, states))
        assert errors.max() > 1e-4


def test_exudyns_own_weight_forgets_the_displacement() -> None:
    """Its moment about the root is that of the undeformed mass centre; forces on modes are right."""
    subject = floating()
    states = states_of(subject).at_rest()
    right, own = engine_of(subject), engine_of(subject, own_weight=True)
    difference = own.bias(states) - right.bias(states)
    assert np.abs(difference[:, :3]).max() < 1e-11 and np.abs(difference[:, 6:]).max() < 1e-11
    still = replace(states, q=np.where(np.arange(states.q.shape[1]) < 7, states.q, 0.0))
    undeformed = right.bias(still)
    np.testing.assert_allclose(own.bias(states)[:, 3:6], undeformed[:, 3:6], atol=1e-11)
    assert np.abs(difference[:, 3:6]).max() > 0.05


@pytest.mark.parametrize(
    ("changed", "word"),
    [
        ({"foreshortening": True}, "foreshortening"),
        ({"retain": "first_order"}, "first_order"),
        ({"twist": 1, "GJ": 1.0, "rhoJ": 0.1}, "twist"),
        ({"rotary_inertia": True}, "rotary inertia"),
        ({"joint": sf.Joint("root", "revolute")}, "revolute"),
        ({"loads": (sf.BeamLoad((0, 1.0, 0), at=1.0),)}, "loads"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_what_it_cannot_represent_is_named(changed: dict[str, Any], word: str) -> None:
    subject = floating()
    beam = replace(subject.system.bodies[0], **changed)
    answer = exudyn_frf.build(replace(subject, system=replace(subject.system, bodies=(beam,))))
    assert isinstance(answer, Unsupported) and word in answer.reason
