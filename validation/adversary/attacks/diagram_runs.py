"""Diagrams from fine to coarse steps: a mass on springs and a floor under a sampled controller, against finer runs."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from hypothesis import strategies as st

import symofros as sf
from symofros import blocks

from ...mechanics.geometry import Array
from ..attack import (
    Attack,
    Mechanism,
    Scene,
    Verdict,
    compared,
    decades,
    inertia,
    refused,
    undecided,
)
from ..motion import MOVED, UNNOTED, UNNOTED_ENERGY, predictable

_PERIOD = 0.1
# Forces between samples: none, a spring that hardens, a floor that is touched for a moment.
_FORCES = {"none": "0*x[0]", "hard": "-1e3*x[0]^3", "floor": "-9.81*m[0] + max(0, -1e5*x[0])"}


@cache
def mass() -> Mechanism:
    """A mass m on a spring k and a damper c."""
    elements = (sf.Spring(sf.formula("k")), sf.Damper(sf.formula("c")))
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements, actuated=True)
    parameters = tuple(sf.Parameter(name, 1.0) for name in ("m", "k", "c"))
    return Mechanism(sf.System("mass", (sf.RigidBody("mass", joint, inertia("m")),), parameters, gravity=(0, 0, 0)))


@cache
def diagram(force: str, law: str) -> sf.Simulation:
    """The mass under a force of x and a sampled PD, by a formula or a function of Python's."""
    one = sf.Diagram(f"{force}_{law}")
    one.add_model("plant", mass().system, start={"x": 1.0})
    if law == "formula":
        pd: Any = blocks.Formula(name="pd", formulas={"force": ["-x[0] - 0.2*v[0]"]}, period=_PERIOD)
    else:
        pd = blocks.PythonBlock(
            name="pd", function=_pd, inputs={"x": (1,), "v": (1,)}, outputs={"force": (1,)}, period=_PERIOD
        )
    one.add(pd, x="plant.q", v="plant.v")
    one.add(blocks.Constant(name="m", value=[1.0]))
    one.add(
        blocks.Formula(name="all", formulas={"force": [f"{_FORCES[force]} + u[0] + 0*m[0]"]}),
        x="plant.q",
        m="m.y",
        u="pd.force",
    )
    one.add(blocks.ForwardDynamics(name="plant", model="plant"), u="all.force")
    return sf.Simulation(one)


def _pd(t: float, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
    return {"force": -inputs["x"] - 0.2 * inputs["v"]}


_scenes = st.fixed_dictionaries(
    {
        "force": st.sampled_from(["none", "hard", "floor"]),
        "law": st.sampled_from(["formula", "python"]),
        "method": st.sampled_from(["rk4", "euler", "semi_implicit_euler", "dopri5"]),
        "m": decades(-3, 3),
        "k": decades(-3, 6),
        "c": st.sampled_from([0.0, 0.1, 10.0]),
        "step": st.sampled_from([0.001, 0.003, 0.01, 0.03, 0.1]),
        "record": st.sampled_from([0.1, 0.01, 0.5]),
        "span": st.sampled_from([1.0, 5.0, 20.0]),
    }
)


def _values(scene: Scene) -> dict[str, float]:
    return {"m": scene["m"], "k": scene["k"], "c": scene["c"]}


def judge(scene: Scene) -> Verdict:
    """The last speed of a run of fixed steps against adaptive ones."""
    simulation = diagram(scene["force"], scene["law"])
    given: dict[str, Any] = {f"plant.{name}": value for name, value in _values(scene).items()} | {"m.value": scene["m"]}
    t_end, record = scene["span"], scene["record"]
    options: dict[str, Any] = {"dt": scene["step"]} if scene["method"] != "dopri5" else {}
    run = simulation.run(t_end, method=scene["method"], record=record, parameters=given, **options)
    if not run.outcome.ok or run.outcome.notes:
        return refused(run.outcome)
    fine = simulation.run(t_end, method="dop853", rtol=1e-10, atol=1e-13, record=record, parameters=given)
    other = given | {name: given[name] * (1.0 + MOVED) for name in ("plant.m", "m.value")}
    moved = simulation.run(t_end, method="dop853", rtol=1e-10, atol=1e-13, record=record, parameters=other)
    if not (fine.outcome.ok and moved.outcome.ok):
        return undecided(f"finer run: {fine.outcome}")
    largest = float(np.abs(fine.v).max())
    mine, i, k = _common(run.t, fine.t, moved.t)
    last = predictable(np.abs(moved.v[k] - fine.v[i]).max(axis=1), largest)
    claim = f"'{run.outcome}', without a note"
    if scene["force"] == "floor":  # Speeds jump where it is touched: an instant earlier or later they are others.
        energy, exact = _energy(scene, run), _energy(scene, fine)
        span = float(np.ptp(exact)) + float(np.abs(exact).max())
        change = abs(float(energy[mine[last]] - exact[i[last]]))
        return compared("energy that came or went", change, UNNOTED_ENERGY * span, claim)
    error = abs(float(run.v[mine[last], 0] - fine.v[i[last], 0]))
    return compared(f"error of the speed at t = {run.t[mine[last]]:.6g} s", error, UNNOTED * largest, claim)


def _common(*times: Array) -> tuple[npt.NDArray[np.intp], ...]:
    """Indices into each array of the instants that all arrays share."""
    shared = times[0]
    for other in times[1:]:
        shared = np.intersect1d(shared, other)
    return tuple(np.searchsorted(t, shared) for t in times)


def _energy(scene: Scene, run: sf.DiagramRun) -> Array:
    """Energy of the mass, its spring and the floor (n) [J]."""
    x, v, m = run.q[:, 0], run.v[:, 0], scene["m"]
    floor = 9.81 * m * x + 0.5e5 * np.minimum(x, 0.0) ** 2
    return np.asarray(0.5 * m * v**2 + 0.5 * scene["k"] * x**2 + floor)


ATTACK = Attack(
    "diagram_runs",
    "a run of a diagram without a note errs by less than three tenths",
    "the eighth-order method at 1e-10, which meets the same samples",
    _scenes,
    lambda scene: mass().at(**_values(scene)),
    judge,
)
