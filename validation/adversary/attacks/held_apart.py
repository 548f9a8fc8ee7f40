"""Bodies that are welded, from relative turns that conditions of vectors can't tell from none."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ...mechanics.geometry import Array
from ..attack import Attack, Mechanism, Scene, Verdict, compared, inertia, refused, undecided

# Angle by which a weld may turn in a run [rad].
HELD = 1e-5


@cache
def welded() -> Mechanism:
    """Two free bodies and a weld."""
    a, b = (
        sf.RigidBody(name, sf.Joint(name, "free"), inertia(mass, moments=moments))
        for name, mass, moments in (("a", 2.0, (0.3, 0.4, 0.5)), ("b", 1.0, (0.1, 0.2, 0.25)))
    )
    weld = sf.Closure("weld", ("a", None), ("b", None), ("x", "y", "z"), ("x", "y", "z"))
    return Mechanism(sf.System("welded", (a, b), gravity=(0, 0, 0), constraints=(weld,)))


_scenes = st.fixed_dictionaries(
    {
        "axis": st.sampled_from([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, 0.8]]),
        # Less than half a turn, half a turn, whole turns.
        "short_by": st.sampled_from([0.0, 1e-12, 1e-9, 1e-6, 3.14159265358979]),
        "asked": st.sampled_from(["simulate", "simulate_batch", "equilibrium", "assemble", "modes"]),
        "method": st.sampled_from(["rk4", "dopri5", "generalized_alpha"]),
        "spin": st.sampled_from([0.8, 0.0]),
    }
)


def judge(scene: Scene) -> Verdict:
    """Judge that a vanishing relative turn stays zero."""
    model = welded().model
    half = 0.5 * (np.pi - scene["short_by"])
    q = np.zeros(14)
    q[6], q[10:13], q[13] = 1.0, np.sin(half) * np.array(scene["axis"]), np.cos(half)
    v = np.zeros(12)
    v[4] = v[10] = scene["spin"]
    asked = scene["asked"]
    if asked == "assemble":
        ends = sf.assemble(model, q, v).q
    elif asked in ("equilibrium", "modes"):
        answer = sf.equilibrium(model, q) if asked == "equilibrium" else sf.modes(model, q)
        if getattr(answer, "notes", ()):
            return refused(answer.notes[0])
        ends = getattr(answer, "q", q)
    elif asked == "simulate":
        run = sf.simulate(model, q, v, 0.5, method=scene["method"])
        if not run.outcome.ok or run.outcome.notes:
            return refused(run.outcome)
        ends = run.q[-1]
    elif scene["method"] == "generalized_alpha":
        return undecided("no batches of this method")
    else:
        runs = sf.simulate_batch(model, np.stack([q, q]), np.stack([v, v]), 0.5, method=scene["method"])
        if not runs.outcome(0).ok or runs.outcome(0).notes:
            return refused(runs.outcome(0))
        ends = runs.q_last[0]
    return compared(f"turn of a weld in {asked}", _turn(ends), HELD, "answered without a note")


def _turn(q: Array) -> float:
    """The angle by which b is turned on a [rad]."""
    along = abs(float(q[3:7] @ q[10:14])) / float(np.linalg.norm(q[3:7]) * np.linalg.norm(q[10:14]))
    return 2.0 * float(np.arccos(min(1.0, along)))


ATTACK = Attack(
    "held_apart",
    "what is answered without a note keeps welded bodies in one another's axes",
    "the angle between their quaternions",
    _scenes,
    lambda _: welded().system,
    judge,
)
