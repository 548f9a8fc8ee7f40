"""Events of motions in closed form: every crossing is found, once, in its direction, and at its time."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ...mechanics.geometry import Array
from ..attack import Attack, Mechanism, Scene, Verdict, compared, inertia, refused, worst
from ..motion import claimed_good

# Of a crossing's time, relative to the span: tolerances of the adaptive methods, and errors of rk4's longest step.
TIME = 1e-3
# The midpoint rule turns a unit oscillator by 2 arctan(h/2) = h (1 - h^2/12 + ...) a step: of the span it is late by
# this share, over h^2, which is no fault of its events.
LATE = 1 / 12
# A level that is left by less, relative to the whole way, is touched rather than crossed.
TOUCHED = 1e-4
_METHODS = ("rk4", "dopri5", "dop853", "rodas4", "variational")
_ADAPTIVE = ("dopri5", "dop853", "rodas4")


@cache
def slide() -> Mechanism:
    """A mass on a spring of stiffness k under a constant force F."""
    joint = sf.Joint(
        "z", "prismatic", axis=(0, 0, 1), elements=(sf.Spring(sf.formula("k")),), effort=(sf.formula("F"),)
    )
    # The levels of events, too: formulas stay the same, and so does what is compiled.
    parameters = tuple(sf.Parameter(name, 1.0) for name in ("k", "F", "e", "f"))
    return Mechanism(sf.System("slide", (sf.RigidBody("b", joint, inertia(1.0)),), parameters, gravity=(0, 0, 0)))


# Stiffness, force, span of time; all begin at zero with the speed 1.
_MOTIONS = {"thrown": (0.0, -1.0, 1.9), "swinging": (1.0, 0.0, 20.0), "flying": (0.0, 0.0, 2.0)}

_scenes = st.fixed_dictionaries(
    {
        "motion": st.sampled_from(list(_MOTIONS)),
        "method": st.sampled_from(_METHODS),
        # Level of a coordinate over its range; instant over the span.
        "of": st.sampled_from(["position", "time", "pair"]),
        "level": st.sampled_from([0.5, 0.25, 0.9, 0.95, 0.99, 0.999]),
        "direction": st.sampled_from(["both", "rising", "falling"]),
        "terminal": st.booleans(),
        # Fixed steps: crossings fall on their ends, too.
        "step": st.sampled_from([0.1, 0.01, 0.25, 0.125]),
        "records": st.sampled_from([0, 50]),
    }
)


def _values(scene: Scene) -> dict[str, float]:
    k, force, _ = _MOTIONS[scene["motion"]]
    first, second = _levels(scene)
    return {"k": k, "F": force, "e": first, "f": second}


def _levels(scene: Scene) -> tuple[float, float]:
    """The level of an event, and one that lies as close as a step."""
    span = _MOTIONS[scene["motion"]][2]
    top = span if scene["of"] == "time" else float(np.max(position(scene["motion"], np.linspace(0.0, span, 20_001))))
    return scene["level"] * top, min(scene["level"] + 0.01, 0.9995) * top


def position(motion: str, t: Array) -> Array:
    """z(t) in closed form."""
    if motion == "swinging":
        return np.asarray(np.sin(t))
    return np.asarray(t + 0.5 * _MOTIONS[motion][1] * t**2)


def _formula(scene: Scene) -> tuple[str, Any, float]:
    """An event: its formula, the same as a function of (t, z), and the size of its values."""
    first, second = _levels(scene)
    if scene["of"] == "time":
        return "t - e", lambda t, z: t - first, first
    if scene["of"] == "position":
        return "z - e", lambda t, z: z - first, first
    return "(z - e)*(z - f)", lambda t, z: (z - first) * (z - second), first * (second - first)


def crossings(values: Any, motion: str, size: float, direction: str) -> Array:
    """Times of the zeros of a formula, by bisection between fine samples."""
    t = np.linspace(0.0, _MOTIONS[motion][2], 40_001)
    sign = np.sign(values(t, position(motion, t)) + 1e-14 * size)
    found = []
    for i in np.flatnonzero(sign[1:] != sign[:-1]):
        if direction == "both" or (sign[i + 1] > 0) == (direction == "rising"):
            low, high = t[i], t[i + 1]
            for _ in range(50):
                middle = 0.5 * (low + high)
                here = np.sign(values(middle, position(motion, middle)))
                low, high = (middle, high) if here == sign[i] else (low, middle)
            found.append(low)
    return np.array(found)


def judge(scene: Scene) -> Verdict:
    """The events of a run against the zeros of the motion in closed form."""
    motion, span = scene["motion"], _MOTIONS[scene["motion"]][2]
    text, values, size = _formula(scene)
    late = scene["method"] == "variational" and motion == "swinging"
    allowed = (TIME + LATE * scene["step"] ** 2 * late) * span
    exact = crossings(values, motion, size, scene["direction"])
    exact = exact[(exact > TOUCHED * span) & (exact < (1.0 - TOUCHED) * span)]
    event = sf.Event(text, scene["direction"], scene["terminal"])
    options: dict[str, Any] = {} if scene["method"] in _ADAPTIVE else {"dt": scene["step"]}
    if scene["records"]:
        options["output"] = np.linspace(0.0, span, scene["records"])
    par = slide().par(**_values(scene))
    run = sf.simulate(
        slide().model, [0.0], [1.0], span, par=par, method=scene["method"], events={"crossed": event}, **options
    )
    if scene["terminal"] and len(exact):
        claim = f"'{run.outcome}'"
        return compared("end by a terminal event", abs(run.outcome.t - exact[0]), allowed, claim)
    if not claimed_good(run):
        return refused(run.outcome)
    found, claim = np.array([one.t for one in run.events]), f"'{run.outcome}', without a note"
    # Of a motion that is late the last crossings may lie behind the end.
    least = int(np.count_nonzero(exact < span - allowed))
    missed = abs(len(found) - min(max(len(found), least), len(exact)))
    number = compared("number of events that are missed or reported twice", missed, 0.5, claim)
    if missed or not len(found):
        return number
    errors = np.abs(found - exact[: len(found)])
    return worst(number, compared("time of an event", float(errors.max()), allowed, claim))


ATTACK = Attack(
    "event_runs",
    "a run without a note finds every crossing of an event once, and ends at the first terminal one",
    "zeros of the motion in closed form",
    _scenes,
    lambda scene: slide().at(**_values(scene)),
    judge,
)
