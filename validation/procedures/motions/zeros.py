"""Zeros of events where closed forms have them: many in a step, close together, far away; by every stepper."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from importlib import util
from typing import Any

import numpy as np

import symofros as sf

from ..machines import TAPE
from ..scene import Cell, Scene, off

LOCATED = 1e-8
_T_END = 2.0
# Formula of t -> its zeros up to _T_END: times and whether it rises there.
_OF_TIME: Mapping[str, tuple[tuple[float, bool], ...]] = {
    "sin(20*t)": tuple((k * math.pi / 20, k % 2 == 0) for k in range(1, 13)),
    "(t - 0.7)*(t - 0.701)": ((0.7, False), (0.701, True)),
    "(t - 0.33)*(t - 0.34)*(t - 0.36)": ((0.33, True), (0.34, False), (0.36, True)),
    "t - 1.25": ((1.25, True),),
    "1.5 - t": ((1.5, False),),
    "exp(5*t) - exp(4)": ((0.8, True),),
    "t^2 + 0.1": (),
    "-1 - t": (),
    "abs(t - 1) - 0.25": ((0.75, False), (1.25, True)),
    "abs(t - 0.8808) - 0.0008": ((0.88, False), (0.8816, True)),  # A kink between two that are near.
    "abs(t - 1.003007) - 7e-6": ((1.003, False), (1.003014, True)),
    "t^3 - 3*t^2 + 2.609375*t - 0.609375": ((0.375, True), (1.0, False), (1.625, True)),
}
_WAYS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("rk4", {"dt": 0.25}),
    ("rk4", {"dt": 0.0625}),
    ("euler", {"dt": 0.1}),
    ("dopri5", {"rtol": 1e-6, "atol": 1e-8}),
    ("dop853", {"rtol": 1e-6, "atol": 1e-8}),
    ("rodas4", {"dt": 0.1}),
    ("generalized_alpha", {"dt": 0.1}),
    ("cvode", {"rtol": 1e-6, "atol": 1e-8}),
)


def of_time(_: Scene) -> Iterator[Cell]:
    """Zeros of formulas of t: all of them, in both directions and in one, whatever the step."""
    slide = sf.RigidBody("block", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0))
    model = sf.compile(sf.System("slide", (slide,), gravity=(0, 0, 0)), TAPE)
    for method, options in _WAYS:
        if method == "cvode" and util.find_spec("sksundae") is None:
            yield Cell("zeros by cvode", 0.0, LOCATED, absent="pip install scikit-sundae")
            continue
        events: dict[str, sf.Event] = {}
        wanted: dict[str, list[float]] = {}
        for k, (formula, zeros) in enumerate(_OF_TIME.items()):
            for direction in ("both", "rising", "falling"):
                name = f"{k} {direction}"
                events[name] = sf.Event(formula, direction)
                wanted[name] = [t for t, rises in zeros if direction == "both" or rises == (direction == "rising")]
        run = sf.simulate(model, [0.3], [0.5], _T_END, method=method, events=events, **options)
        yield Cell(f"zeros of formulas by {method}, {next(iter(options.values())):g}", *_missed(run.events, wanted))


def _missed(events: Any, wanted: Mapping[str, Any], bound: float = LOCATED) -> tuple[float, float, str]:
    """Largest error of times, 1 for each that is lost or made up; the bound; which were wrong."""
    worst, wrong = 0.0, []
    for name, times in wanted.items():
        found = [one.t for one in events if one.name == name]
        error = (
            abs(len(found) - len(times)) + off(np.array(found), np.array(times)) if len(found) == len(times) else 1.0
        )
        if error > bound:
            wrong.append(f"{name}: {found}")
        worst = max(worst, error)
    times = [one.t for one in events]
    return worst + float(times != sorted(times)), bound, "; ".join(wrong)[:200]


def of_motions(_: Scene) -> Iterator[Cell]:
    """Zeros of oscillations of several frequencies, by runs, steppers and batches; with ends at one of them."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=(sf.formula("-k*x"),))
    parameters = (sf.Parameter("k", 4.0),)
    body = sf.RigidBody("mass", joint, sf.Inertia(1.0))
    model = sf.compile(sf.System("oscillator", (body,), parameters, gravity=(0, 0, 0)), TAPE)
    w = np.array([2.0, 3.0, 5.0, 7.0, 0.3, 4.0, 6.0, 2.5, 3.5])
    events = {
        "below": sf.Event("x - 0.3", "falling"),
        "above": sf.Event("x - 0.3", "rising"),
        "turn": sf.Event("dx"),
        "both": sf.Event("x*dx"),
        "far": sf.Event("x - 5"),
        "first": sf.Event("x + 0.2", once=True),
    }
    wanted = [_of_oscillation(float(one)) for one in w]
    given: tuple[tuple[str, dict[str, Any], float], ...] = (
        ("rk4", {"dt": 2e-3}, 1e-6),
        ("dopri5", {"rtol": 1e-9, "atol": 1e-11}, 1e-7),
        ("dop853", {"rtol": 1e-9, "atol": 1e-11}, 1e-6),
    )
    for method, options, bound in given:
        for k in (0, 3, 4):
            run = sf.simulate(model, [1.0], t_end=_T_END, par=[w[k] ** 2], method=method, events=events, **options)
            yield Cell(f"zeros of {w[k]:g} rad/s by {method}", *_missed(run.events, wanted[k], bound))
        batch = sf.simulate_batch(
            model, np.ones((len(w), 1)), t_end=_T_END, par=w[:, None] ** 2, method=method, events=events, **options
        )
        worst = max(_missed(batch.events(k), wanted[k], bound)[0] for k in range(len(w)))
        yield Cell(f"zeros in a batch by {method}", worst, bound)
    stepper, many = (
        sf.Stepper(model, dt=2e-3, events=events),
        sf.Steppers(model, len(w), par=w[:, None] ** 2, dt=2e-3, events=events),
    )
    stepper.reset([1.0], par=[w[3] ** 2])
    stepper.step(steps=1000)
    many.reset(np.ones((len(w), 1)))
    for _k in range(10):
        many.step(steps=100)
    worst = max(_missed(many.events(k), wanted[k], 1e-6)[0] for k in range(len(w)))
    yield Cell("zeros by steps by hand", max(worst, _missed(stepper.events, wanted[3], 1e-6)[0]), 1e-6)
    ends = {"end": sf.Event("x - 0.3", "falling", terminal=True)}
    batch = sf.simulate_batch(
        model, np.ones((len(w), 1)), t_end=_T_END, par=w[:, None] ** 2, dt=2e-3, method="rk4", events=ends
    )
    times = np.minimum(math.acos(0.3) / w, _T_END)
    yield Cell("ends of a batch", off(np.asarray(batch.t_last), times), 1e-6)


def _of_oscillation(w: float) -> dict[str, list[float]]:
    """Times of the zeros of cos(w t) - 0.3 and the others up to _T_END."""

    def times(at: Callable[[int], float], first: int = 0) -> list[float]:
        listed = [at(k) / w for k in range(first, 40)]
        return [t for t in listed if 0.0 < t < _T_END]

    a, b = math.acos(0.3), math.acos(-0.2)
    return {
        "below": times(lambda k: a + 2 * math.pi * k),
        "above": times(lambda k: -a + 2 * math.pi * k),
        "turn": times(lambda k: math.pi * k),
        "both": times(lambda k: 0.5 * math.pi * k),
        "far": [],
        "first": times(lambda _: b)[:1],
    }
