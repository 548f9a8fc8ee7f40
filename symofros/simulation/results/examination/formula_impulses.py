"""Forces by a model's own formulas of time that change within fixed steps: their impulse, and what steps make of it.

docs/theory/simulation.md, section 8, (18d).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.simulation.results.examination.input_impulses import AT_END, POINTS, RATE, evaluated, nodes
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.stepper import Stepper

# Steps that are looked at, at most.
_STEPS = 512


def formula_impulse_note(run: ExaminedRun) -> str:
    """Forces of the model's own whose impulse fixed steps misjudge (18d), in words; nothing where they do no harm."""
    stepper, settings, (t, q, v, u) = run.stepper, run.settings, run.states
    if settings.adaptive or not stepper.model.nv or not len(t):
        return ""
    h, t0, t_end = settings.dt, settings.t0, float(t[-1])
    instants = stepper.model.formula_instants([], stepper.par, t0, t_end)
    place = (instants - t0) / h
    k = np.unique(np.floor(place[np.abs(place - np.rint(place)) > AT_END]))[:_STEPS]
    if not len(k):
        return ""
    begin, end = t0 + k * h, np.minimum(t0 + (k + 1) * h, t_end)
    rows = np.minimum(np.maximum(np.searchsorted(t, begin + AT_END * h) - 1, 0), len(t) - 1)
    with np.errstate(all="ignore"):
        missed = np.cumsum(_missed(stepper, settings, (q[rows], v[rows], u[rows]), instants, begin, end), axis=0)
        sizes, fastest = run.norms(q[rows], u[rows], missed), run.fastest
    worst = int(np.argmax(np.nan_to_num(sizes)))
    if not sizes[worst] > TOLERANCE * fastest:
        return ""
    share = f"off by {100.0 * sizes[worst] / fastest:.2g} % of the largest" if fastest > 0.0 else "all that would move"
    return (
        f"steps of {h:.4g} s misjudge forces by formulas of time, which change within them: at t = {end[worst]:.6g} s"
        f" the speeds that they give are {share}; a smaller dt or an adaptive method"
    )


def _missed(
    stepper: Stepper, settings: Settings, at: tuple[Array, Array, Array], instants: Array, begin: Array, end: Array
) -> Array:
    """Changes of speed by the accelerations at held states (n) over steps, less what the steps make of them (n, nv)."""
    x, weights = np.polynomial.legendre.leggauss(POINTS)
    cuts = np.unique(np.concatenate([begin, end, instants]))
    low, high = cuts[:-1], cuts[1:]
    step = np.searchsorted(begin, 0.5 * (low + high)) - 1
    within = (step >= 0) & (0.5 * (low + high) < end[np.maximum(step, 0)])
    low, high, step = low[within], high[within], step[within]
    total, half = np.zeros((len(begin), stepper.model.nv)), 0.5 * (high - low)
    for place, weight in zip(x, weights, strict=True):
        np.add.at(total, step, (weight * half)[:, np.newaxis] * _held(stepper, at, step, low + (1.0 + place) * half))
    all_steps, h = np.arange(len(begin)), (end - begin)[:, np.newaxis]
    c, method_weights, of_rate = nodes(settings.method)
    for node, weight in zip(c, method_weights, strict=True):
        if weight:
            total -= weight * h * _held(stepper, at, all_steps, begin + node * h[:, 0])
    if of_rate:
        here, ahead = (_held(stepper, at, all_steps, begin + way * h[:, 0]) for way in (0.0, RATE))
        total -= of_rate * h * (ahead - here) / RATE
    return total


def _held(stepper: Stepper, at: tuple[Array, Array, Array], rows: npt.NDArray[np.intp], t: Array) -> Array:
    """Accelerations (n, nv) at some of the states and at times (n)."""
    given = dict(zip("qvu", (group[rows] for group in at), strict=True)) | {"t": t[:, np.newaxis]}
    return evaluated(stepper, "forward_dynamics", given, len(t))
