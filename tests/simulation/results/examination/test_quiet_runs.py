"""A run that is right bears no note: reference models by every method, against the same motion to tighter bounds."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import GUESSES, compiled, sampled

RIGHT = 1e-9
TIGHT: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-13}
# Steps [s], and bounds of errors, from coarse to fine: a note may speak of what is off by more than RIGHT.
STEPS = [{"dt": 1e-2}, {"dt": 1e-3}]
BOUNDS = [{}, {"rtol": 1e-9, "atol": 1e-11}, TIGHT]
METHODS = {
    "rk4": STEPS,
    "semi_implicit_euler": STEPS,
    "generalized_alpha": STEPS,
    "variational": STEPS,
    "rodas4": [*BOUNDS, {"dt": 1e-3, "adaptive": False}],
    "dopri5": [*BOUNDS, {"dt": 1e-3, "adaptive": False}],
    "dop853": [*BOUNDS, {"dt": 1e-2, "adaptive": False}],
    "cvode": BOUNDS,
    "ida": BOUNDS,
}
TREES = (
    "double_pendulum",
    "cart_pole",
    "rx90",
    "chain7",
    "heavy_top",
    "gyroscope",
    "space_arm",
    "joint_zoo",
    "puma560",
)
LOOPS = ("four_bar", "slider_crank", "parallelogram", "bricard", "stewart", "sleigh", "rolling_disc")
ELASTIC = ("flexible_pendulum", "soft_pendulum", "spinning_beam", "planar_robot", "flexible_slider_crank")
SAMPLE = ("double_pendulum", "slider_crank", "flexible_pendulum")
# What is said of the mechanism and not of the numbers: limits are data, friction is smooth, beams have their theory.
OF_THE_MECHANISM = ("limits", "so that the joint creeps", "second-order theory errs")
T_END = 0.5
# Ends [s]: before a singular posture, in which rounding decides on the branch and two runs to 1e-13 differ by 4e-8;
# of a rod that is pushed at all its modes, the fastest at 66 000 rad/s.
SHORT = {"parallelogram": 0.1, "flexible_slider_crank": 2e-3}
# What a method refuses: variational integrators take no motion that is prescribed.
REFUSED = {("spinning_beam", "variational")}


@cache
def start(name: str) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    """A model, and a motion's beginning: pushed, on the constraints."""
    model = compiled(name)
    rng = np.random.default_rng(7)
    if model.nc:
        first = sf.assemble(model, GUESSES.get(name, model.neutral()), 0.3 * rng.standard_normal(model.nv))
        return model, first.q, first.v
    q, v = model.random_state(rng)
    return (model, model.neutral(), 0.0 * v) if name in ELASTIC else (model, q, 0.3 * v)


@cache
def truth(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Configuration and speeds at the end: bounds of 1e-13, and the same by half of any step."""
    model, q, v = start(name)
    t_end = SHORT.get(name, T_END)
    ends = [sf.simulate(model, q, v, t_end, method="dop853", rtol=1e-13, atol=1e-15, max_step=h) for h in (1e-2, 5e-3)]
    assert off(model, ends[0], (ends[1].q[-1], ends[1].v[-1])) < 0.1 * RIGHT
    return ends[1].q[-1], ends[1].v[-1]


def off(model: sf.Model, run: sf.Trajectory, right: tuple[np.ndarray, np.ndarray]) -> float:
    """The largest error at the end, relative to what is larger than one."""
    apart, faster = model.difference(right[0], run.q[-1]), run.v[-1] - right[1]
    sizes = (np.abs(model.difference(model.neutral(), right[0])), np.abs(right[1]))
    return max(float((np.abs(x) / np.maximum(size, 1.0)).max()) for x, size in zip((apart, faster), sizes, strict=True))


@pytest.mark.parametrize("name", sampled((*TREES, *LOOPS, *ELASTIC), SAMPLE))
def test_accurate_runs_get_no_note(name: str) -> None:
    model, q, v = start(name)
    quiet = 0
    for method, settings in METHODS.items():
        for options in settings:
            if (model.nc and method in ("variational", "cvode")) or (name, method) in REFUSED:
                continue
            run = sf.simulate(model, q, v, SHORT.get(name, T_END), method=method, **options)
            if not run.outcome.ok or off(model, run, truth(name)) > RIGHT:
                continue
            notes = [note for note in run.outcome.notes if not any(one in note for one in OF_THE_MECHANISM)]
            assert not notes, (method, options, notes)
            quiet += 1
    assert quiet >= 2


@pytest.mark.parametrize(("dt", "words"), [(2e-3, ""), (4e-3, ""), (1e-2, "past the limit of stability")])
def test_a_body_that_lies_on_a_stiff_floor_is_not_said_to_swing_on_it(dt: float, words: str) -> None:
    """Rounding excites the floor's mode, 316 rad/s; steps that amplify it are named whatever they begin from."""
    joint = sf.Joint("z", "prismatic", axis=(0, 0, 1))
    floor = sf.Contact("floor", ("block", None), ("world", None), 1e5, exponent=1.0, radius=0.1, dissipation=5.0)
    model = sf.compile(sf.System("lying", (sf.RigidBody("block", joint, sf.Inertia(1.0)),), connections=(floor,)))
    run = sf.simulate(model, [0.1 - 9.81 / 1e5], t_end=4.0, dt=dt, method="rk4")
    assert bool(run.outcome.notes) == bool(words) and all(words in note for note in run.outcome.notes)
