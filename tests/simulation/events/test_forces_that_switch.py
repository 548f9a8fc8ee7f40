"""Forces that bend or jump: a motion over them that is off by three hundredths bears a note, a right one is quiet.

Stops, bristles, springs that switch, backlash, motors with saturation; against tolerances of 1e-10.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.results.examination.switched_run import SwitchedRun

f = sf.formula
AXIS, ROD, END = (0, -1, 0), sf.Inertia(1.0, (0.5, 0, 0), (0, 1 / 12, 1 / 12)), (sf.Frame("end", (1, 0, 0)),)
PARAMETERS = {
    **{"k": 1e4, "c": 0.0, "low": -0.5, "high": 0.5, "gap": 0.1, "soft": 10.0},
    **{"bristle": 3000.0, "lag": 10.0, "level": 2.0, "A": 5.0, "w": 3.0, "gain": 20.0, "rate": 2.0, "most": 5.0},
}
ELEMENTS: dict[str, tuple[Any, ...]] = {
    "stop": (sf.Stop("k", "c", lower="low", upper="high"),),
    "bristles": (sf.LuGre("level", "bristle", "lag"), sf.Spring("soft")),
    "slips": (sf.Hysteresis("bristle", "level"), sf.Spring("soft")),
}
FORCES = {
    "backlash": "-k*(max(j0 - gap, 0) - max(-gap - j0, 0))",
    "switches": "-(k*(j0 - gap) + c*dj0)*max(sign(j0 - gap), 0)",
    "turns": "-A*tanh(bristle*(j0 - gap))",
    "rises": "A*(1 - 2/(1 + exp(-bristle*(j0 - gap))))",
}
LAWS: dict[str, Any] = {
    "none": None,
    "driven": {"j0": "A*sin(w*t)"},
    "motor": {"j0": "max(-most, min(most, gain*(0.6*sin(w*t) - j0) - rate*dj0))"},
}
KINDS = [("slide", "stop"), ("double", "switches"), ("loop", "stop")]
OTHERS = [
    ("pendulum", "bristles"),
    ("slide", "bristles"),
    ("pendulum", "backlash"),
    ("double", "slips"),
    ("loop", "switches"),
    ("double", "stop"),
    ("slide", "turns"),
    ("double", "rises"),
]
# Errors that are worth a note, a tenth more for instants that are not compared: where forces bend, and where none does;
# what is right.
WRONG, PLAIN, RIGHT = 0.033, 0.11, 1e-9


@cache
def model_of(mechanism: str, element: str) -> sf.Model:
    """A slide, pendulums or a four-bar with an element at its first joint."""
    first: dict[str, Any] = {"elements": ELEMENTS.get(element, (sf.Spring("soft"),)), "actuated": True}
    hinge = sf.RigidBody("b0", sf.Joint("j0", "revolute", axis=AXIS, **first), ROD, END)
    bodies, loops = (hinge,), ()
    if mechanism == "slide":
        bodies = (sf.RigidBody("b0", sf.Joint("j0", "prismatic", axis=(0, 0, 1), **first), sf.Inertia(1.0)),)
    if mechanism == "double":
        bodies += (sf.RigidBody("b1", sf.Joint("j1", "revolute", "b0", "end", axis=AXIS), ROD, END),)
    if mechanism == "loop":
        coupler = sf.Inertia(2.0, (1.0, 0, 0), (0, 2 / 3, 2 / 3))
        joint, pivot = (
            sf.Joint("j1", "revolute", "b0", "end", axis=AXIS),
            sf.Joint("j2", "revolute", position=(2.0, 0, 0), axis=AXIS),
        )
        bodies += (
            sf.RigidBody("b1", joint, coupler, (sf.Frame("end", (2, 0, 0)),)),
            sf.RigidBody("b2", pivot, sf.Inertia(1.5, (0.75, 0, 0), (0, 0.28, 0.28)), (sf.Frame("end", (1.5, 0, 0)),)),
        )
        loops = (sf.Closure("loop", ("b2", "end"), ("b1", "end"), ("x", "z")),)
    power = (sf.VirtualPower(element, {"dj0": f(FORCES[element])}),) if element in FORCES else ()
    parameters = tuple(sf.Parameter(*item) for item in PARAMETERS.items())
    return sf.compile(sf.System(mechanism, bodies, parameters, virtual_power=power, constraints=loops))


def drawn(mechanism: str, element: str, rng: np.random.Generator) -> tuple[Any, Any, dict[str, Any]]:
    """A start and what acts."""
    ranges = {"w": (1, 10), "A": (1, 20), "level": (0.5, 6), "most": (2, 30), "gap": (0.02, 0.3)}
    powers = {"k": (3, 8), "bristle": (2, 5), "lag": (0, 1.5), "gain": (1, 3), "soft": (0, 3)}
    par = {name: float(rng.uniform(*span)) for name, span in ranges.items()}
    par |= {name: float(10 ** rng.uniform(*span)) for name, span in powers.items()}
    par |= {"c": float(10 ** rng.uniform(0, 3)) * (rng.random() < 0.6), "rate": par["gain"] * rng.uniform(0.02, 0.2)}
    middle = 1.4 if mechanism == "loop" else 0.0
    par |= {"low": middle - rng.uniform(0.2, 0.6), "high": middle + rng.uniform(0.1, 0.4), "gap": middle + par["gap"]}
    given = {"par": {**PARAMETERS, **par}, "u": LAWS[str(rng.choice(list(LAWS)))], "t_end": float(rng.uniform(1, 2))}
    model = model_of(mechanism, element)
    if mechanism == "loop":
        guess = {"j0": 1.4, "j1": -1.12, "j2": 1.6}
        start = sf.assemble(model, guess, {"j0": rng.uniform(-2, 2)}, held=("j0",), par=given["par"])
        return start.q, start.v, given
    q = rng.uniform(-1, 1, model.nq)
    q[0] = rng.uniform(par["low"], par["high"])
    return q, rng.uniform(-3, 3, model.nv), given


def options_of(mechanism: str, element: str, rng: np.random.Generator) -> dict[str, Any]:
    """A method, with steps or tolerances from coarse to fine."""
    if rng.random() < 0.45:
        method = str(rng.choice(["dopri5", "dop853", "rodas4"]))
        return {"method": method, "rtol": 10 ** rng.uniform(-9, -3), "atol": 10 ** rng.uniform(-10, -5)}
    names = ["euler", "semi_implicit_euler", "rk4", "rk4", "dopri5", "generalized_alpha", "implicit_euler", "rodas4"]
    names += ["variational"] if mechanism != "loop" and element in ("stop", *FORCES) else []
    method = str(rng.choice(names))
    fixed = {"adaptive": False} if method in ("dopri5", "rodas4") else {}
    return {"method": method, "dt": float(10 ** rng.uniform(-4, -2)), **fixed}


def off(run: sf.Trajectory, right: sf.Trajectory, par: Any) -> float:
    """Largest error of displacements, and of speeds at the end or in the mean, relative to the largest of each."""
    model, q, v = right.model, right.q, right.v
    M = model.mass_matrix(q, par=par)

    def norms(x: Any) -> Any:
        return np.sqrt(np.maximum(np.einsum("ni,nij,nj->n", x, M, x), 0.0))

    far = norms(model.difference(np.broadcast_to(q[0], q.shape), q)).max()
    apart, faster = norms(model.difference(q, run.q)), norms(run.v - v)
    return float(max(apart.max() / far, max(faster[-1], faster.mean()) / norms(v).max()))


def judged(mechanism: str, element: str, rng: np.random.Generator) -> tuple[float, float, tuple[str, ...], Any] | None:
    """Error of a motion, what is worth a note, and its notes; None where it fails, or 1e-10 does not determine it."""
    model, (q, v, given) = model_of(mechanism, element), drawn(mechanism, element, rng)
    options = options_of(mechanism, element, rng)
    at = {"output": np.linspace(0.0, given["t_end"], 1025)}
    run = sf.simulate(model, q, v, **given, **at, **options)
    if not run.outcome.ok:
        return None
    method = "dopri5" if element in ("stop", *FORCES) else "rodas4"
    bounds = [{"method": method, "rtol": rtol, "atol": rtol / 10, "max_steps": 50_000} for rtol in (1e-10, 1e-8)]
    right, near = (sf.simulate(model, q, v, **given, **at, **bound) for bound in bounds)
    par = model.checked_parameters(given["par"])
    if not (right.outcome.ok and near.outcome.ok) or off(near, right, par) > 0.003:
        return None
    states = {"t": right.t[:, np.newaxis], "q": right.q, "v": right.v, "u": right.u}
    if model.nz:
        states["q"], states["v"] = (np.hstack([x, right.z]) for x in (right.q, right.v))
    bends = model.formula_instants.bend([], par, states) or given["u"] == LAWS["motor"]
    return off(run, right, par), WRONG if bends else PLAIN, run.outcome.notes, (options, given)


@pytest.mark.parametrize(
    ("mechanism", "element", "number"),
    [(*kind, 6) for kind in KINDS] + [pytest.param(*kind, 40, marks=pytest.mark.slow) for kind in [*KINDS, *OTHERS]],
)
def test_wrong_motions_bear_a_note_and_right_ones_do_not(mechanism: str, element: str, number: int) -> None:
    """Random elements, starts, methods and steps."""
    found = [judged(mechanism, element, np.random.default_rng([number, seed])) for seed in range(number)]
    motions = [one for one in found if one is not None]
    silent = [one for one in motions if one[0] > one[1] and not one[2]]
    assert len(motions) >= number // 2
    # Two pairs of steps may agree by chance on what both have wrong.
    assert len(silent) <= number // 40 and not [one for one in silent if one[0] > PLAIN], silent
    assert not [one for one in motions if one[0] < RIGHT and one[2]]


@pytest.mark.parametrize(
    ("force", "first", "options"),
    [
        ("-3.4*dz/sqrt(dz^2 + 2e-8)/0.3", (0.9, -0.9), {"dt": 2e-3, "t_end": 1.0}),
        ("-2.1*atan(3e3*dz)/0.5", (0.5, 0.4), {"dt": 6.3e-3}),
        ("-2.1*tanh(4e3*dz)/0.5", (0.5, 0.4), {"dt": 6.3e-3}),
        ("43.5*tanh(509*(0.5 - z)) + 0.618", (0.826, 0.175), {"dt": 3.8e-3}),
        ("9.5*(1 - 2/(1 + exp(-170*dz)))/0.3 - 1.5", (0.7, 0.6), {"dt": 7e-4, "method": "implicit_euler"}),
        ("8*tanh(3300*(0.5 - z))/0.3", (0.6, 0.3), {"dt": 1e-3, "method": "semi_implicit_euler"}),
        ("0.5*(exp(-50*(z - 0.2)) - exp(50*(z - 1)))", (0.6, 1.4), {"dt": 3.4e-3, "method": "implicit_euler"}),
    ],
)
def test_forces_that_are_steep_between_states_bend(force: str, first: Any, options: dict[str, Any]) -> None:
    """They have no kink, and were looked at as smooth ones are: off by two to thirty hundredths, in silence."""
    joint = sf.Joint("z", "prismatic", axis=(1, 0, 0), effort=force)
    model = sf.compile(sf.System("steep", (sf.RigidBody("b", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0)))
    t: dict[str, Any] = {"t_end": 1.0, **options, "output": 0.005}
    z, v = first
    run = sf.simulate(model, [z], [v], **t)
    right = sf.simulate(model, [z], [v], t["t_end"], output=0.005, method="dop853", rtol=1e-10, atol=1e-12)
    assert run.outcome.notes and off(run, right, None) > 0.02
    fine = sf.simulate(model, [z], [v], t["t_end"], output=0.005, method="dopri5", rtol=1e-9, atol=1e-11)
    assert off(fine, right, None) < 1e-3 and not fine.outcome.notes


FALL: dict[str, Any] = {"par": {**PARAMETERS, "k": 1e6, "low": -0.3, "high": 3.0}, "t_end": 3.0}


@pytest.mark.parametrize(
    ("options", "wrong"),
    [
        ({"method": "dopri5", "rtol": 1e-3, "atol": 1e-6}, True),
        ({"method": "dopri5", "rtol": 1e-9, "atol": 1e-11}, False),
        ({"method": "rk4", "dt": 1e-3}, True),
        ({"method": "rk4", "dt": 4e-5}, False),
    ],
)
def test_executors_say_of_a_stop_what_a_single_run_says(options: dict[str, Any], wrong: bool) -> None:
    """A pendulum that falls on its stop; a batch, and, of fixed steps, steps by hand."""
    model, par = model_of("pendulum", "stop"), FALL["par"]
    fine = sf.simulate(model, **FALL, method="dop853", rtol=1e-12, atol=1e-13)
    run = sf.simulate(model, **FALL, **options)
    assert (abs(run.q[-1, 0] - fine.q[-1, 0]) > 0.01) == wrong == bool(run.outcome.notes), str(run.outcome)
    batch = sf.simulate_batch(model, np.zeros((2, 1)), **FALL, **options)
    assert batch.outcome(1).notes == run.outcome.notes
    if "dt" in options:
        stepper = sf.Stepper(model, par=par, **options)
        stepper.step(steps=round(FALL["t_end"] / options["dt"]))
        assert stepper.outcome.notes == run.outcome.notes


@pytest.mark.parametrize(("method", "rtol", "wrong"), [("cvode", 1e-4, True), ("cvode", 1e-8, False)])
def test_runs_by_sundials_over_a_stop_are_compared(method: str, rtol: float, wrong: bool) -> None:
    pytest.importorskip("sksundae")
    run = sf.simulate(model_of("pendulum", "stop"), **FALL, method=method, rtol=rtol, atol=1e-3 * rtol)
    assert bool(run.outcome.notes) == wrong, str(run.outcome)


def test_a_stop_that_is_not_reached_costs_no_other_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing bends there."""
    made = list[float]()
    monkeypatch.setattr(SwitchedRun, "fine", lambda run, *_: made.append(run.h))
    given = {"par": {**FALL["par"], "low": -4.0, "high": 4.0}, "t_end": 3.0}
    assert not sf.simulate(model_of("pendulum", "stop"), **given, dt=1e-3).outcome.notes and not made
    assert sf.simulate(model_of("pendulum", "stop"), **FALL, dt=1e-4).outcome.notes and made
