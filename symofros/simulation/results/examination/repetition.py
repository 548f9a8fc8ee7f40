"""Notes on what finer steps, or a tighter tolerance, change of a run.

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

import math

import numpy as np

from symofros.simulation.results.examination.finer_steps import finer_steps_note
from symofros.simulation.results.examination.run import MOST_STEPS, ExaminedRun
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.status import Status

# Fewest records that show where speeds change.
_RECORDS = 3
# Share of the largest speed that the absolute tolerance may allow as the error of a step; displacements over it that
# are a motion and not rest; share of the largest speed that is asked for instead.
_ALLOWED, _MOTION, _TIGHT = 0.1, 100.0, 1e-3
# A run that ends as singular is made once more by steps that are shorter by this, of which there are so many at most.
_SHORTER, _MOST_SHORTER = {8: "an eighth", 64: "a 64th"}, 100_000


def halved_step_note(run: ExaminedRun, *, evident: bool) -> str:
    """Note on how finer steps change a run with fixed steps (17), or that this was not tried; "" if little.

    Args:
        run: The run.
        evident: Whether its modes show that the steps are short enough, so that a short run is not made once more.
    """
    settings, short = run.settings, run.short
    if settings.adaptive or run.steps < 1 or not run.model.nv or (short and evident):
        return ""
    if not short and (settings.realtime or len(run.states[0]) < _RECORDS):
        return ""
    if run.repeatable:
        return finer_steps_note(run)
    if not short or settings.realtime or run.stepper.method.family.multistep:
        return ""
    return (
        f"steps of {settings.dt:.4g} s were not held against half of that: the input function gives other inputs when"
        " it is asked again about a state; compare with a smaller dt"
    )


def shorter_steps_that_go_on(run: ExaminedRun, t: float) -> str:
    """Shorter steps that go on past the time at which a run with fixed steps ends [s], in words; "" where none do."""
    settings = run.settings
    if settings.adaptive or settings.realtime or not run.repeatable:
        return ""
    start, beyond = (settings.t0, *run.start), min(t + 2.0 * settings.dt, settings.t_end)
    for parts, share in _SHORTER.items():
        steps = parts * (run.steps + 2)
        if steps > _MOST_SHORTER:
            break
        if run.repeated(start, beyond, settings.dt / parts, every=steps, beam_limit=math.inf)[0] >= 0:
            return f"the step of {settings.dt:.4g} s is too long: {share} of that goes on past t = {t:.6g} s"
    return ""


def tolerance_note(run: ExaminedRun) -> str:
    """Note on an absolute tolerance that exceeds the speeds and changes the motion; "" if it does no harm."""
    settings, (t, q, v, u) = run.settings, run.states
    if not settings.adaptive or not run.model.nv or run.stepper.method.family.multistep or run.steps < 1:
        return ""
    if run.allowed <= _ALLOWED * run.fastest:  # Some records are enough to tell.
        return ""
    moved, largest = float(np.abs(q - run.start[0]).max()), float(run.norms(q, u, v).max())
    if not (run.allowed > _ALLOWED * largest > 0.0 and moved > _MOTION * settings.atol):
        return ""
    if not run.repeatable:
        return ""
    begin, atol = (settings.t0, *run.start), _TIGHT * largest / run.inertia
    status, tight = run.repeated(begin, float(t[-1]), 0.0, max_steps=MOST_STEPS, atol=atol)
    if status == Status.FINISHED and not run.whole_change([x[-1:] for x in run.states], tight) > TOLERANCE:
        return ""
    fastest = float(np.abs(v[:, run.moving]).max())
    return (
        f"atol = {settings.atol:.3g} bounds no error of speeds that reach {fastest:.3g} only: a tighter bound leads"
        f" elsewhere; atol below {1e-3 * fastest:.1g}"
    )
