"""Exudyn's floating-frame body against our beam, term by term; its nonlinear beams against closed forms."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from validation.accuracy.reference import data
from validation.adapters.exudyn import frf as exudyn_frf
from validation.adapters.exudyn.ancf import Hub, Strip, princeton, spin_up, spinning_frequencies, static_tip
from validation.checking import Settings, check
from validation.comparison.errors import compute, state_errors, typical_scales
from validation.contract.interface import States, Subject, Unsupported
from validation.contract.quantities import QUANTITIES
from validation.inputs.sampling import sample
from validation.mechanics.assembly import assemble

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
def test_the_floating_frame_of_exudyn_matches_term_by_term(changed: dict[str, Any]) -> None:
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


def test_a_check_asks_the_floating_frame_and_finite_elements_of_the_same_beam() -> None:
    result = check(floating(), Settings(states=20, engines=("exudyn-frf", "exudyn-beams")))
    assert result.ok, [row for row in result.comparisons if not row.ok]
    agreeing = {(row.engine, row.quantity) for row in result.comparisons if row.status == "agree"}
    assert {(name, "bias") for name in ("exudyn-frf", "exudyn-beams")} <= agreeing
    (row,) = (row for row in result.comparisons if row.quantity == "strain_order")
    assert row.status == "agree"


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
def test_beams_that_exudyn_cannot_represent_are_named(changed: dict[str, Any], word: str) -> None:
    subject = floating()
    beam = replace(subject.system.bodies[0], **changed)
    answer = exudyn_frf.build(replace(subject, system=replace(subject.system, bodies=(beam,))))
    assert isinstance(answer, Unsupported) and word in answer.reason


@pytest.mark.parametrize("alpha", [0.05, 0.75, 10])
def test_absolute_nodal_coordinates_follow_the_elastica(alpha: float) -> None:
    """Down to its stretch, one over EA L^2/EI."""
    (row,) = (row for row in data("elastica_tip_load")["table"] if row["alpha"] == alpha)
    exact = (1.0 - row["tip_shortening"], row["tip_y"])
    errors = [float(np.abs(static_tip(1.0, 1.0, 1e5, (0.0, alpha), n) - exact).max()) for n in (4, 16)]
    assert errors[1] < 1e-5 * alpha + 1e-8
    assert errors[0] > 20 * errors[1]  # Four elements show, so elements do matter.


def test_a_pull_along_the_axis_stretches() -> None:
    assert static_tip(2.0, 1.0, 1e4, (5.0, 0.0), 4) == pytest.approx([2.0 * (1.0 + 5e-4), 0.0], abs=1e-12)


def test_stretch_lowers_the_spinning_frequency() -> None:
    """In the plane and in proportion to 1/EA, by more than Coriolis' force along the axis alone explains."""
    soft, stiff, stiffer = (spinning_frequencies(1.0, EA, 12.0, elements=16)[1][0] for EA in (1e5, 1e6, 1e7))
    assert (stiffer - soft) / (stiffer - stiff) == pytest.approx((1e-5 - 1e-7) / (1e-6 - 1e-7), rel=0.01)
    # 2 W v' along the axis stretches it in phase: -2 W^2/EA int (int_x^1 phi)^2/int phi^2, which is 0.75 for the first
    # mode at rest; steady stretch adds a little.
    coefficient = (1.0 - stiff / stiffer) / (144.0 * (1e-6 - 1e-7))
    assert 0.75 < coefficient < 1.1


@pytest.mark.parametrize(("eta", "tolerance"), [(0, 5e-5), (3, 6e-5), (12, 2e-4)])
@pytest.mark.parametrize("delta", [0, 1])
def test_absolute_nodal_coordinates_stiffen_when_they_spin(eta: int, delta: int, tolerance: float) -> None:
    """Three frequencies in each plane; with half the elements it is measurably worse."""
    (row,) = (r for r in data("spinning_cantilever")["table"] if r["eta"] == eta and r["delta"] == delta)
    worst = []
    for elements in (8, 16):
        flap, chord = spinning_frequencies(1.0, 1e6, eta, delta, elements)
        worst.append(max(np.abs(flap / row["flap"][:3] - 1).max(), np.abs(chord / row["chord"][:3] - 1).max()))
    assert worst[1] < tolerance < worst[0]


def test_spin_up_follows_the_exact_rod() -> None:
    """Across to 0.35 mm, an error of the time step; along it stays out by the stretch of a spinning bar."""
    rod = data("spin_up")["exact_inextensible_rod"]
    t, tip = spin_up(elements=8, step=5e-3)
    chosen = [int(np.abs(t - at).argmin()) for at in rod["t"]]
    error = tip[chosen] - np.stack([rod["tip_x"], rod["tip_y"]], axis=-1)
    assert np.abs(error[:, 1]).max() < 3.5e-4
    hub = Hub()
    stretch = hub.rate**2 * hub.rhoA * hub.length**3 / (3 * 1e6 * hub.EI / hub.length**2)
    assert error[-1, 0] == pytest.approx(stretch, rel=5e-3)


def test_the_strip_bends_as_beams_do_under_small_loads() -> None:
    """Each way by its own stiffness, with the shear of its section; without twist to first order."""
    strip, load = Strip(), 1e-3
    coarse, fine = (princeton(load, np.pi / 4, n) for n in (8, 16))
    force, L = load * np.sqrt(0.5), strip.length
    exact = force * (L**3 / 3 / np.array([strip.EI_z, strip.EI_y]) + L / strip.GA)
    errors = np.array([coarse[0][1:] - exact, fine[0][1:] - exact])
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.01)
    assert (4 * fine[0] - coarse[0])[1:] / 3 == pytest.approx(exact, rel=1e-5)


def test_the_strip_twists_under_the_load() -> None:
    """The load times its arm is a torque: the section turns by more than a degree at 45 degrees, not at 0 and 90."""
    turns = [princeton(8.896, angle, 8)[1] for angle in (0.0, np.pi / 4, np.pi / 2)]
    rolls = [float(np.arctan2(turn[2, 1], turn[1, 1])) for turn in turns]
    assert rolls[1] == pytest.approx(-0.02906, abs=1e-4)  # Of Exudyn 1.13.6, the same with 64 elements.
    assert abs(rolls[0]) < 1e-9 and abs(rolls[2]) < 1e-9
