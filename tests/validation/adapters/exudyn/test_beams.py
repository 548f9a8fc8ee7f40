"""Exudyn's nonlinear beams against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from validation.accuracy.reference import data
from validation.adapters.exudyn.ancf import SlenderBeam, Strip, princeton, spin_up, spinning_frequencies, static_tip


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
    hub = SlenderBeam()
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
