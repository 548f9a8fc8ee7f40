"""Constraints that a sampled block engages with a gap: bodies don't jump, and momentum stays."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st

import symofros as sf
from symofros import blocks

from ..attack import Attack, Mechanism, Scene, Verdict, compared, inertia, refused, worst

# Share of the sizes of a scene by which positions and momentum may change in the instant, for rounding.
UNMOVED = 1e-6
_INSTANT, _SPAN = 0.5, 1.0


@cache
def sliders() -> Mechanism:
    """Two carts, of masses 1 and m, that a coupling may tie."""
    bodies = tuple(
        sf.RigidBody(name, sf.Joint(f"x{name}", "prismatic", axis=(1, 0, 0)), inertia(mass))
        for name, mass in (("a", 1.0), ("b", "m"))
    )
    grip = sf.Coupling("grip", sf.formula("xb - xa - d"))
    parameters = (sf.Parameter("m", 1.0), sf.Parameter("d", 0.0))
    return Mechanism(sf.System("sliders", bodies, parameters, gravity=(0, 0, 0), constraints=(grip,)))


@cache
def diagram(speed_a: float, speed_b: float) -> sf.Simulation:
    """The carts, which begin at one place with these speeds, and are tied at an instant."""
    one = sf.Diagram("grip")
    one.add_model("plant", sliders().system, start={"dxa": speed_a, "dxb": speed_b})
    one.add(blocks.Formula(name="when", formulas={"on": [f"max(0, sign(t - {_INSTANT - 1e-9!r}))"]}, period=0.1))
    one.add(blocks.ForwardDynamics(name="plant", model="plant", engaged=True), engaged="when.on")
    return sf.Simulation(one)


_scenes = st.fixed_dictionaries(
    {
        "m": st.sampled_from([1.0, 1e-3, 1e3]),
        # Gap of the carts when they are tied, and their speeds.
        "gap": st.sampled_from([0.0, 1e-9, 1e-4, 1e-2, 1.0]),
        "speeds": st.sampled_from([[0.0, 0.0], [1.0, -1.0], [0.0, 2.0]]),
        "method": st.sampled_from(["rk4", "dopri5", "semi_implicit_euler"]),
        "step": st.sampled_from([1e-2, 1e-3]),
    }
)


def _values(scene: Scene) -> dict[str, float]:
    """The mass, and the distance that the tie asks for: short by the gap of what there is at the instant."""
    first, second = scene["speeds"]
    return {"m": scene["m"], "d": (second - first) * _INSTANT - scene["gap"]}


def judge(scene: Scene) -> Verdict:
    """Positions before and after the instant, and the momentum of all."""
    m, first = scene["m"], np.array(scene["speeds"])
    options: dict[str, Any] = {} if scene["method"] == "dopri5" else {"dt": scene["step"]}
    given = {f"plant.{name}": value for name, value in _values(scene).items()}
    run = diagram(*scene["speeds"]).run(_SPAN, method=scene["method"], record=_INSTANT, parameters=given, **options)
    if not run.outcome.ok or run.outcome.notes:
        return refused(run.outcome)
    mean = float((first[0] + m * first[1]) / (1.0 + m))
    exact, size = first * _INSTANT + mean * (_SPAN - _INSTANT), 1.0 + scene["gap"]
    claim = f"'{run.outcome}', without a note"
    shift = float(np.abs(run.q[-1] - exact).max())
    momentum = abs(float(run.v[-1, 0] + m * run.v[-1, 1]) - (first[0] + m * first[1]))
    return worst(
        compared("jump of bodies as they are tied", shift, UNMOVED * size, claim),
        compared("momentum as they are tied", momentum, UNMOVED * (1.0 + m) * 2.0, claim),
    )


ATTACK = Attack(
    "engaging_runs",
    "a constraint that engages without a note takes speeds onto itself and moves no body",
    "momentum, and the positions of free motion",
    _scenes,
    lambda scene: sliders().at(**_values(scene)),
    judge,
)
