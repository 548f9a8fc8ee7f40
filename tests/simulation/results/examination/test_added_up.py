"""Errors that add up over a long run, of which no window shows a tenth: docs/theory/simulation.md, (17b)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.examination.finer_steps import Changed, Part
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.windows import Window
from tests.simulation.oscillator import oscillator

STEPS, H = 6000, 0.01


def window(count: int) -> Window:
    """So many steps from the start."""
    return Window(0, None, count * H)


def a_run(method: str, every: int = 1) -> ExaminedRun:
    """A run of the oscillator from x = 1, with a record at each or some of the ends of its steps."""
    model = oscillator()
    settings = Settings.of(model, SimulationOptions(method=method, dt=H, adaptive=False), STEPS * H)
    stepper = Stepper(model, settings.method, plan_inputs(model, None), (), np.array([1.0, 0.0]))
    settings.apply(stepper)
    run = ExaminedRun(stepper, settings, (np.ones(1), np.zeros(1)), [], STEPS)
    _, states = run.repeated((0.0, *run.start), STEPS * H, H)
    return replace(run, states=[x[::every] for x in states])


@pytest.mark.parametrize(("power", "longest"), [(0.0, 64), (1.0, 64), (2.0, 4096)])
def test_parts_grow_until_the_power_of_their_growth_says_what_the_run_comes_to(
    power: float, longest: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Changes of 1e-5 in eight steps: 7.5e-3 over the run where they grow with time, 5.6 where with its square."""
    looked_at = []

    def changed(run: ExaminedRun, part: Window, _: Part, every: int = 1) -> Changed:
        count = round(part.t_end / H)
        looked_at.append(count)
        return Changed(1e-5 * (count / 8) ** power, 0.0, count)

    monkeypatch.setattr(ExaminedRun, "changed", changed)
    worst = a_run("rk4").added_up(Changed(1e-5, 0.0, 8))
    assert max(looked_at) == longest
    assert (worst.share > TOLERANCE) == (power == 2.0)


def test_a_symplectic_method_is_let_off_after_a_part_and_one_that_gains_energy_is_not() -> None:
    """Semi-implicit Euler errs by h/2 forever; Euler's method by h/2 of the phase and of the size a radian."""
    symplectic, gaining = a_run("semi_implicit_euler"), a_run("euler")
    first = symplectic.changed(window(8), "window")
    assert first.arrived and first.share < TOLERANCE
    assert symplectic.added_up(first).share < TOLERANCE
    first = gaining.changed(window(8), "window")
    assert first.arrived and first.share < TOLERANCE < gaining.added_up(first).share


@pytest.mark.parametrize("every", [7, 60])
def test_sparse_records_show_what_dense_ones_do(every: int) -> None:
    """What half the step changes in a part is the same, made once more or from the records."""
    dense, sparse = a_run("rk4"), a_run("rk4", every)
    for count, between in ((8, 1), (500, 3), (STEPS, 23)):
        seen = [run.changed(window(count), "part", between) for run in (dense, sparse)]
        assert seen[0].arrived and seen[1].arrived
        assert seen[1].share == pytest.approx(seen[0].share, rel=1e-6, abs=1e-12), count


def test_a_light_body_on_a_stiff_spring_counts_by_the_energy_that_it_holds() -> None:
    """The second difference of V is k x^2, wherever the spring is: (17a)."""
    run = a_run("rk4")
    t, q, u = np.zeros(3), np.array([[0.0], [0.3], [-2.0]]), np.zeros((3, 1))
    norms = run._potential_norms((t, q, u), np.array([[1.0], [0.5], [-0.1]]))
    assert norms == pytest.approx([1.0, 0.5, 0.1])
