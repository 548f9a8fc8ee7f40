"""Runs note how far they bend their beams, and end where second-order theory does (docs/theory/beams.md, section 6)."""

from __future__ import annotations

import math

import numpy as np
import pytest

import symofros as sf
from symofros.runtime.beams import BeamBending
from tests.simulation.beam_models import cantilever, critical_load

METHODS = ("rk4", "semi_implicit_euler", "dopri5", "rodas4", "generalized_alpha")


def swung(load: float, **changes: object) -> sf.Trajectory:
    """A tip force that comes on at once."""
    model = cantilever().with_parameters(F=load)
    return sf.simulate(model, t_end=1.0, **{"dt": 1e-3, **changes})  # type: ignore[arg-type]


def beam_notes(outcome: sf.Outcome) -> list[str]:
    """Notes on the theory of beams."""
    return [note for note in outcome.notes if "second-order theory errs" in note]


@pytest.mark.parametrize("method", METHODS)
def test_a_run_ends_where_a_beam_bends_beyond_its_theory(method: str) -> None:
    limp = cantilever().with_parameters(g=60.0)
    run = sf.simulate(limp, t_end=2.0, method=method, dt=1e-4)
    assert run.outcome.kind == "beyond theory" and not run.outcome.ok
    assert run.outcome.t == pytest.approx(0.143, abs=3e-3)
    assert "'blade'" in run.outcome.reason and "rad at x = " in run.outcome.reason
    assert run.t[-1] == run.outcome.t
    assert run.bendings[0].error == pytest.approx(0.5, abs=0.02)
    assert sf.simulate(limp, t_end=0.3, dt=1e-4, beam_limit=math.inf).outcome.kind == "finished"


def test_a_note_names_the_largest_bending_between_recorded_states() -> None:
    run = swung(0.3, output=[0.0, 1.0])
    (note,) = beam_notes(run.outcome)
    (bending,) = run.bendings
    assert "'blade'" in note and "t = " in note and 0.0 < bending.t < 1.0
    every = swung(0.3)
    slopes = [cantilever().beams()[0].bending(q).slope for q in every.q]
    # Slack of (26d): a tenth of the error, 5 % of the slope.
    assert max(slopes) / 1.05 <= bending.slope <= max(slopes) * (1.0 + 1e-12)
    assert bending.t == pytest.approx(every.t[int(np.argmax(slopes))], abs=0.05)
    assert not beam_notes(swung(0.1).outcome)


def test_the_steps_judge_as_python_does() -> None:
    strip = sf.Beam(
        "strip", sf.Joint("root", "fixed"), 0.5, 1.0, EI_z=16.0, EI_y=1.0, GJ=2.0, rhoJ=0.1, bend_y=2, bend_z=2, twist=2
    )
    model = sf.compile(sf.System("strip", (strip,)))
    rng = np.random.default_rng(1)
    q = 0.05 * rng.normal(size=(20, model.nq)) * np.repeat([1, 1, 10], 2)
    runs = sf.simulate_batch(model, q, t_end=0.0, beam_limit=math.inf)
    errors = [model.beams()[0].bending(row).error for row in q]
    assert runs.beam_errors[:, 0] == pytest.approx(errors, rel=1e-12)


def strips(*factors: str) -> sf.Model:
    """Strips beside each other that do not touch, with so many times a stiffness."""
    made = tuple(
        sf.Beam(
            f"strip_{k}",
            sf.Joint(f"root_{k}", "fixed"),
            0.5,
            1.0,
            EI_z=f"16*{k}",
            EI_y=k,
            GJ=f"2*{k}",
            rhoJ=0.1,
            bend_y=2,
            bend_z=2,
            twist=1,
        )
        for k in factors
    )
    parameters = tuple(sf.Parameter(k, 1.0 + i) for i, k in enumerate(factors))
    return sf.compile(sf.System("strips", made, parameters=parameters, gravity=(0, 0, 0)))


def test_each_beam_of_a_mechanism_is_judged_as_if_it_were_alone() -> None:
    """They bend across their stiff side first, and further across the other later."""
    beside, alone = strips("k0", "k1", "k2"), strips("k0")
    rng = np.random.default_rng(4)
    v, n = rng.normal(size=beside.nv) * np.tile([2, 2, 1, 1, 10], 3), alone.nv
    options = {"t_end": 0.2, "dt": 1e-3, "method": "rk4", "beam_limit": math.inf}
    together = sf.simulate(beside, None, v, **options)
    for i, bending in enumerate(together.bendings):
        single = sf.simulate(alone.with_parameters(k0=1.0 + i), None, v[i * n : (i + 1) * n], **options).bendings[0]
        assert (
            bending.t > 0.0
            and bending.error == pytest.approx(single.error, rel=1e-9)
            and bending.t == pytest.approx(single.t)
        )


def test_each_trajectory_of_a_batch_is_judged_by_its_own_length() -> None:
    model = cantilever()
    lengths = np.array([0.5, 1.0, 2.0])
    par = np.tile(model.parameter_values, (3, 1))
    par[:, model.names.par.index("L")], par[:, model.names.par.index("F")] = lengths, 0.5
    runs = sf.simulate_batch(model, t_end=4.0, par=par, dt=1e-3)
    alone = [sf.simulate(model, t_end=4.0, par=row, dt=1e-3) for row in par]
    assert list(runs.kinds) == [run.outcome.kind for run in alone] == ["finished", "finished", "beyond theory"]
    for run, single in zip(runs, alone, strict=True):
        assert beam_notes(run.outcome) == beam_notes(single.outcome)
        assert run.bendings[0].error == pytest.approx(single.bendings[0].error, rel=1e-9)
    assert "'blade'" in runs.outcome(2).reason
    assert "beams bend much in 2, first: [1]: beam 'blade'" in str(runs)


@pytest.mark.parametrize("share", [-5.0, 0.0, 0.8, 0.95])
@pytest.mark.parametrize("L", [1e-3, 30.0])
def test_axial_loads_amplify_the_error_of_runs_and_modes_as_that_of_rest(share: float, L: float) -> None:
    """A column that rests is an equilibrium, a motion and the state of modes: one beam, one error."""
    P, F = share * critical_load() / L**2, 0.2 * (1.0 - share) / L**2
    m = cantilever().with_parameters(P=P, F=F, L=L)
    rest = sf.equilibrium(m)
    (bent,) = rest.bendings
    span = 0.2 * L**2
    run = sf.simulate(m, rest.q, t_end=span, dt=span / 200)
    runs = sf.simulate_batch(m, rest.q[None], t_end=span, dt=span / 200)
    others = (sf.modes(m, rest.q).bendings, run.bendings, runs.bendings(0))
    assert [one[0].error for one in others] == pytest.approx([bent.error] * 3, rel=1e-6)
    assert [len(beam_notes(one.outcome)) for one in (run, runs[0])] == [int(bent.error > 0.01)] * 2
    assert not [note for note in run.outcome.notes if "determine the motion" in note]


def test_a_column_near_its_critical_load_is_noted_though_its_slope_is_small() -> None:
    m = cantilever().with_parameters(P=0.97 * critical_load(), F=0.004)
    run = sf.simulate(m, t_end=20.0, dt=2e-3, output=0.1)
    assert run.bendings[0].slope < 0.14 and len(beam_notes(run.outcome)) == 1
    ended = sf.simulate(m, t_end=20.0, dt=2e-3, output=0.1, beam_limit=0.01)
    assert ended.outcome.kind == "beyond theory" and not ended.outcome.ok


@pytest.mark.parametrize(("error", "percent"), [(0.012, "1.2"), (0.5, "50"), (12.345, "1234"), (3.2e75, "3.2e+77")])
def test_estimated_errors_are_printed_with_few_digits(error: float, percent: str) -> None:
    assert f"errs by about {percent} % of" in str(BeamBending("strip", 1.0, 2.0, 0.0, 0.1, error))
