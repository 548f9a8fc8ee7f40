"""Friction that is smooth holds nothing at rest: a joint that creeps under load at the end of a run is named."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.analysis.friction import friction_curve
from tests.simulation.mechanisms import slide

ADAPTIVE = ("dopri5", "rodas4")


@cache
def block() -> sf.Model:
    """1 kg on a plane, with a spring of no stiffness until it is given one."""
    friction = sf.Friction(1.0, static="rise", minimum_velocity="v0", viscous="c")
    values = {"rise": 1.2, "v0": 1e-3, "c": 0.0, "k": 0.0}
    parameters = tuple(sf.Parameter(name, value) for name, value in values.items())
    return sf.compile(slide(friction, sf.Spring("k"), actuated=True, parameters=parameters))


def creeps(run: sf.Trajectory) -> list[str]:
    return [note for note in run.outcome.notes if "so that the joint creeps" in note]


@pytest.mark.parametrize(("load", "v0"), [(-0.9, 1e-2), (0.1, 1e-3), (0.5, 1e-5)])
def test_a_joint_that_creeps_is_named_with_its_load(load: float, v0: float) -> None:
    m = block().with_parameters(v0=v0, c=0.3)
    run = sf.simulate(m, t_end=5.0, u={"x": load}, method="rodas4")
    assert abs(run.v[-1, 0]) < 2.0 * v0
    (note,) = creeps(run)
    most = 1.2 + 0.3 * 15 / 8 * v0  # With what the damper carries at the peak.
    assert note.startswith("'x' ends at") and f"carries {abs(load):.2g} of the {most:.3g} that" in note
    many = (
        sf.simulate_batch(m, np.zeros((1, 1)), t_end=5.0, u={"x": load}, dt=1e-2 * v0, output=0.1)
        if v0 > 1e-3
        else None
    )
    assert many is None or creeps(many[0])


@pytest.mark.parametrize("force", [1e-9, 1.0, 1e9])
def test_friction_levels_off_at_the_same_speed_whatever_its_unit(force: float) -> None:
    parameters = (sf.Parameter("F", force),)
    system = slide(sf.Friction("F", minimum_velocity=1e-3), parameters=parameters)
    m = sf.compile(system, sf.Options(("dynamics",), backend="interpreter"))
    speeds = np.concatenate([[0.0], np.geomspace(1e-5, 1.0, 51)])
    state = m.neutral(), np.zeros(1), np.zeros(0)
    curve = friction_curve(m, 0, speeds, state, None, 0.0)
    assert curve is not None and 5e-4 < speeds[curve.flat] < 1e-2
    assert curve.reached == pytest.approx(force, rel=0.05) and curve.carried.max() == pytest.approx(force, rel=1e-3)


@pytest.mark.parametrize("first", [2e-4, 1.2e-3, 1.6e-3, 1.7e-3])
def test_friction_reaches_its_peak_from_any_first_speed(first: float) -> None:
    """The peak is beyond the speed at which the force levels off, which may be the first beside the present one."""
    m = sf.compile(
        slide(sf.Friction(1.0, 1.2, minimum_velocity=1e-3)), sf.Options(("dynamics",), backend="interpreter")
    )
    speeds = np.concatenate([[0.0], np.geomspace(first, 1e4 * first, 400)])
    curve = friction_curve(m, 0, speeds, (m.neutral(), np.zeros(1), np.zeros(0)), None, 0.0)
    assert curve is not None and curve.reached == pytest.approx(1.2, rel=1e-3)


@pytest.mark.parametrize("method", ADAPTIVE)
def test_sliding_swinging_and_resting_blocks_get_no_note(method: str) -> None:
    slides = sf.simulate(block(), t_end=5.0, u={"x": 1.3}, method=method)
    rests = sf.simulate(block(), t_end=5.0, method=method)
    stops = sf.simulate(block(), [0.0], [1.0], 5.0, method=method)  # Nothing loads it.
    swings = sf.simulate(block().with_parameters(k=100.0, v0=0.05), [1.0], [0.0], np.pi / 10, method=method)
    assert abs(swings.v[-1, 0]) < 0.05  # At its turning point, where the spring brakes it.
    for run in (slides, rests, stops, swings):
        assert not creeps(run), run.outcome


@pytest.mark.parametrize(("load", "v0"), [(-0.05, 1e-5), (0.5, 1e-1), (1.19, 1e-3)])
def test_failed_equilibria_with_friction_are_explained(load: float, v0: float) -> None:
    m = block().with_parameters(v0=v0, c=0.1)
    with pytest.raises(sf.EquilibriumError) as refused:
        sf.equilibrium(m, u=[load])
    said = str(refused.value)
    assert f"friction of 'x' carries {abs(load):.3g} in motion only, up to 1.2" in said
    assert "smooth through zero speed and holds nothing at rest" in said and "held=['x']" in said
    # The remedy, as it stands.
    assert sf.equilibrium(m, u=[load], held=["x"]).efforts == pytest.approx({"x": -load})


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("load", "begun"), [(0.9, 0.3), (0.9, -0.3), (-0.9, 0.3), (0.4, 0.0)])
def test_friction_about_a_motion_is_what_a_change_of_speed_adds(side: float, load: float, begun: float) -> None:
    """From the speed of the motion on, the way the imbalance accelerates it; the same for the mirrored motion."""
    v0, m = 1e-3, block().with_parameters(v0=1e-3)
    at, away = side * begun * v0, side * load

    def friction(speed: float) -> float:
        return float(m.dynamics([0.0], [speed], [0.0])[2][0])

    imbalance = friction(at) + away
    with pytest.raises(sf.EquilibriumError) as refused:
        sf.equilibrium(m, v=[at], u=[away])
    most = 1.2 + np.sign(imbalance) * friction(at)  # The peak against it, less what there is.
    assert f"friction of 'x' carries {abs(imbalance):.3g} in motion only, up to {most:.3g}" in str(refused.value)


def test_imbalance_beyond_static_friction_is_not_attributed_to_friction() -> None:
    """Beyond static friction, and with a place of rest."""
    with pytest.raises(sf.EquilibriumError) as refused:
        sf.equilibrium(block(), u=[1.3])
    assert "friction" not in str(refused.value) and "imbalance of" in str(refused.value)
    assert sf.equilibrium(block().with_parameters(k=10.0), u=[0.5]).q == pytest.approx([0.05])
