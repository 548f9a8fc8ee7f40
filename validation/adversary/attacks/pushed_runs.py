"""Short pushes of long runs: samples with lines or held, formulas of time, forces of a small place."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st

import symofros as sf

from ..attack import Attack, Mechanism, Scene, Verdict, decades, inertia
from ..motion import UNNOTED, claim_verdict

# Error of an adaptive run at its defaults, relative to the largest speed; fixed steps may err by UNNOTED.
ADAPTIVE = 1e-2
_SPAN = 10.0
# Width of a hill [m] from which it is promised to be met or noted: runs are looked into at 512 states at least, here
# 0.02 s and as many metres apart (docs/theory/simulation.md, section 8).
_PROMISED = 0.03
_ADAPTIVE = ("dopri5", "dop853", "rodas4", "cvode")


@cache
def cart(wall: bool) -> Mechanism:
    """A cart of mass m that an input pushes; with a narrow hill of height A and width w at x = 5 if asked for."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True)
    # Of a push by formula: when it is largest, half its length, how large.
    names = ("m", "A", "w") if wall else ("m", "T", "H", "F")
    hill = (sf.Potential("hill", sf.formula("A*exp(-((x - 5)/w)^2)")),) if wall else ()
    parameters = tuple(sf.Parameter(name, 1.0) for name in names)
    body = sf.RigidBody("cart", joint, inertia("m"))
    return Mechanism(sf.System("cart", (body,), parameters, gravity=(0, 0, 0), potentials=hill))


_scenes = st.fixed_dictionaries(
    {
        "push": st.sampled_from(["lines", "held", "half sine", "formula", "hill"]),
        "method": st.sampled_from(["rk4", "dopri5", "dop853", "rodas4", "cvode", "semi_implicit_euler"]),
        "m": decades(-3, 3),
        # Begin and length of the push [s]; of a hill, its width over 10 m.
        "begin": st.sampled_from([3.0, 0.0, 0.123, 9.5]),
        "length": st.sampled_from([0.3, 1.0, 0.03, 0.003, 1e-4]),
        "speed": st.sampled_from([0.0, 1.0]),
        "step": st.sampled_from([1e-2, 1e-3, 0.1]),
        "records": st.sampled_from([0, 101, 2]),
        "batch": st.booleans(),
    }
)


def _values(scene: Scene) -> dict[str, float]:
    m = scene["m"]
    # A hill of twice the energy that the cart arrives with.
    if scene["push"] == "hill":
        return {"m": m, "A": m, "w": max(scene["length"], _PROMISED)}
    begin, length = _pulse(scene)
    return {"m": m, "T": begin + 0.5 * length, "H": 0.5 * length, "F": 2.0 * m / length}


def _pulse(scene: Scene) -> tuple[float, float]:
    """Begin and length of a push."""
    return scene["begin"], min(scene["length"], _SPAN - scene["begin"])


def _mechanism(scene: Scene) -> Mechanism:
    return cart(scene["push"] == "hill")


def _law(scene: Scene) -> Any:
    """The push: an impulse of m, in any shape."""
    begin, length = _pulse(scene)
    middle, top = begin + 0.5 * length, 2.0 * scene["m"] / length
    if scene["push"] == "lines":
        t, force = [begin, middle, begin + length], [0.0, top, 0.0]
    elif scene["push"] == "held":
        t, force = [begin, begin + length], [0.5 * top, 0.0]
    elif scene["push"] == "half sine":
        t = list(np.linspace(begin, begin + length, 31))
        shape = np.sin(np.linspace(0.0, np.pi, 31))
        force = list(scene["m"] * shape / np.trapezoid(shape, t))
    else:
        return "F*max(0, 1 - abs(t - T)/H)"
    if begin > 0.0:
        t, force = [0.0, *t], [0.0, *force]
    return sf.Signal(t, force, "hold" if scene["push"] == "held" else "linear")


def judge(scene: Scene) -> Verdict:
    """The last state: the first speed and the impulse over the mass, from the middle of the push on; or back again."""
    one, hill = _mechanism(scene), scene["push"] == "hill"
    model, par, first = one.model, one.par(**_values(scene)), 1.0 if hill else scene["speed"]
    law = {} if hill else {"x": _law(scene)}
    options: dict[str, Any] = {} if scene["method"] in _ADAPTIVE else {"dt": scene["step"]}
    records: dict[str, Any] = {"output": np.linspace(0.0, _SPAN, scene["records"])} if scene["records"] else {}
    steps = {"method": scene["method"], "max_steps": 200_000} | options

    def moved(**recorded: Any) -> sf.Trajectory:
        return sf.simulate(model, [0.0], [first], _SPAN, u=law, par=par, **steps, **recorded)

    in_batch = scene["batch"] and scene["method"] != "cvode"
    if not in_batch:
        run = moved(**records)
        outcome, place, speed = run.outcome, float(run.q[-1, 0]), float(run.v[-1, 0])
    else:
        options = {"method": scene["method"]} | options | records
        runs = sf.simulate_batch(model, np.zeros((2, 1)), np.full((2, 1), first), _SPAN, u=law, par=par, **options)
        outcome, place, speed = runs.outcome(0), float(runs.q_last[0, 0]), float(runs.v_last[0, 0])
    exact = -first if hill else first + 1.0
    share = abs(speed - exact) / max(1.0, abs(exact))
    if hill:  # Energy that is off on the way, recorded or not, is an error, too: that of speeds is half as large.
        whole = moved()
        share = max(share, 0.5 * float(np.ptp(whole.energy)) / float(whole.kinetic_energy.max()))
    else:  # A push that is met late leaves the right speed, and a motion that is off.
        begin, length = _pulse(scene)
        reached = first * _SPAN + _SPAN - begin - 0.5 * length
        share = max(share, abs(place - reached) / max(1.0, abs(reached)))
    bound = ADAPTIVE if scene["method"] in _ADAPTIVE else UNNOTED
    return claim_verdict(outcome, "error of the last state", share, bound)


ATTACK = Attack(
    "pushed_runs",
    "a run without a note has met every push: adaptive ones err by a hundredth, fixed steps by three tenths; a run "
    "that is right has no note",
    "the impulse and its moment, and the energy before a hill that is too high",
    _scenes,
    lambda scene: _mechanism(scene).at(**_values(scene)),
    judge,
)
