"""Constraints that engage, joints that stick, actions of events: against models without them and closed forms.

Momentum, energy and relative poses tell whether an impact is right (docs/theory/constraints.md, 13); an oscillator with
dry friction loses 2 F/k each half period, and one on an incline stands to the last bit (14).
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf

from ...contract.quantities import ROUNDING
from ..formats.exported import printed
from ..scene import Cell, Scene, off

# Needs no compiler, and is a machine of its own.
_TAPE = sf.Options(backend="tape")
SAME, STEPPED, LOCATED = 0.5, 1e-10, 1e-7
_CONDITIONS = ("constraint", "constraint_rate", "constraint_bias", "constraint_jacobian")
_AXES: Any = ("x", "y", "z")
_G, _SLOPE = 9.81, 0.3
_T_GRAB, _T_DROP, _T_END = 0.0203, 0.04, 0.06


def grasping(pose: str = "moment", switched: bool = True) -> sf.System:
    """Two bodies that float, an arm on one of them, and three closures between them, two of which may hold at a time.

    Args:
        pose: What switches hold.
        switched: Whether there are switches.
    """
    end = sf.Frame("end", (0.9, 0.1, 0.0), sf.Rotation.rpy(0.2, -0.1, 0.4))
    handle = sf.Frame("handle", (0.2, 0.1, -0.05), sf.Rotation.rpy(0.1, 0.3, 0.7))
    solid = sf.Inertia(sf.formula("m"), (0.1, 0.05, -0.03), (0.3, 0.2, 0.25))
    base = sf.RigidBody("base", sf.Joint("root", "free"), sf.Inertia(5.0, (0.1, 0, 0), (1, 2, 3)), (end,))
    elbow = sf.Joint("q1", "revolute", "base", "end", axis=(0, 0.6, 0.8))
    arm = sf.RigidBody("arm", elbow, sf.Inertia(1.0, (0.4, 0.02, 0.01), (0.01, 0.1, 0.11)), (replace(end, name="tip"),))
    targets = tuple(sf.RigidBody(name, sf.Joint(f"f{name}", "free"), solid, (handle,)) for name in ("one", "two"))
    closures = (
        sf.Closure("grasp", ("arm", "tip"), ("one", "handle"), rotations=_AXES),
        sf.Closure("dock", ("one", "handle"), ("two", "handle"), rotations=_AXES),
        sf.Rod("rope", ("base", "end"), ("two", None), 0.7),
    )
    names = tuple(zip(("grasp", "dock", "rope"), ("grip", "weld", "taut"), strict=True))
    switches = tuple(sf.Switch(constraint, name, pose) for constraint, name in names)  # type: ignore[arg-type]
    parameters = (sf.Parameter("m", 2.0), *(sf.Parameter(name, 0.0) for _, name in names))
    return sf.System(
        "grasping",
        (base, arm, *targets),
        parameters,
        gravity=(0, 0, 0),
        constraints=closures,
        switches=switches if switched else (),
    )


def engaged(_: Scene) -> Iterator[Cell]:
    """Rows of conditions that hold are those of a model without switches; released they are zero."""
    options = sf.Options(_CONDITIONS, backend="interpreter")
    plain, model = (sf.compile(grasping("stated", switched), options) for switched in (False, True))
    q, v = model.random_state(np.random.default_rng(13))
    spans, first = {}, 0
    for name in ("grasp", "dock", "rope"):
        count = sum(text.split(".")[0] == name for text in model.names.constraints)
        spans[name], first = slice(first, first + count), first + count
    shares = {"grip": 1.0, "weld": 0.0, "taut": 1.0}
    par = np.array([shares.get(name, model.parameters[name]) for name in model.names.par])
    given = {"constraint": (q,), "constraint_jacobian": (q,), "constraint_rate": (q, v), "constraint_bias": (q, v)}
    for function in _CONDITIONS:
        wanted = np.array(getattr(plain, function)(*given[function]))
        for rows, share in zip(spans.values(), shares.values(), strict=True):
            wanted[rows] *= share
        values = getattr(model, function)(*given[function], par=par)
        yield Cell(f"switched {function.replace('_', ' ')}", off(values, wanted), ROUNDING)


_PLAN = {
    "grab": sf.Event(f"t - {_T_GRAB}", action={"grip": 1}, once=True),
    "tie": sf.Event("t - 0.0305", action={"weld": 1}, once=True),
    "drop": sf.Event(f"t - {_T_DROP}", action={"grip": "1 - grip", "dq1": 0.1, "m": "1.5*m"}),
}


def grasped(_: Scene) -> Iterator[Cell]:
    """A grasp, a second one while it holds, a release: impacts, relative poses, the same by steppers and in batches."""
    model = sf.compile(grasping(), _TAPE)
    rng, count = np.random.default_rng(14), 5
    q, v = (np.array(rows) for rows in zip(*(model.random_state(rng) for _ in range(count)), strict=True))
    v *= 0.5
    given: dict[str, Any] = {"dt": 1e-3, "method": "rk4", "events": _PLAN}
    runs = [sf.simulate(model, q[i], v[i], _T_END, **given) for i in range(2)]
    run = runs[0]
    named = [found.name for found in run.events] != ["grab", "tie", "drop"]
    yield Cell("a plan of grasps", float(named) + float(not run.outcome.ok), SAME)
    if named:
        return
    yield Cell("impacts of grasps", max(_impact(run, k) for k in range(3)), 1e-10)
    ends = [change[0] for change in run.changes]
    frames = {name: run.frames[name] for name in ("tip", "one.handle", "two.handle")}
    worst = 0.0
    for first, second, begin, end in (("tip", "one.handle", 0, 2), ("one.handle", "two.handle", 1, None)):
        (p_A, R_A), (p_B, R_B) = frames[first], frames[second]
        kept = slice(ends[begin] - 1, ends[end] if end is not None else len(run.t))
        gap = np.einsum("nji,nj->ni", R_A, p_B - p_A)[kept]
        turn = np.einsum("nji,njk->nik", R_A, R_B)[kept]
        worst = max(worst, float(np.abs(gap - gap[0]).max()), float(np.abs(turn - turn[0]).max()))
        free = np.einsum("nji,nj->ni", R_A, p_B - p_A)[: ends[begin]]
        worst += float(np.abs(free - free[0]).max() < 1e-4)  # Nothing held before.
    yield Cell("poses that grasps keep", worst, STEPPED)
    stepper, many = sf.Stepper(model, **given), sf.Steppers(model, count, **given)
    stepper.reset(q[0], v[0])
    stepper.step(steps=60)
    differing = int(np.sum(stepper.q != run.q[-1]) + np.sum(stepper.v != run.v[-1]))
    yield Cell("a plan by steps by hand", float(differing), SAME, "entries of other bits")
    many.reset(q, v)
    many.step(steps=60)
    batch = sf.simulate_batch(model, q, v, _T_END, output=0.01, **given)
    error = 0.0
    for i, one in enumerate(runs):
        for other in (many.events(i), batch.events(i)):
            error += float([found.name for found in other] != [found.name for found in one.events])
            error += sum(abs(a.t - b.t) for a, b in zip(other, one.events, strict=False))
        error = max(error, off(many.q[i], one.q[-1]), off(batch.q_last[i], one.q[-1]), off(many.v[i], one.v[-1]))
        error = max(error, off(many.par[i], one.par_over_time[-1]))
    yield Cell("a plan in a batch and by many", error, 1e-9)


def _impact(run: sf.Trajectory, which: int) -> float:
    """What an impact misses: momentum, conditions, impulse, the energy of the speed lost, relative to their sizes."""
    model, found = run.model, run.events[which]
    par = run.par_over_time[run.changes[which][0]]
    v = found.v
    if which == 2:  # A speed is set before constraints act; parameters, too.
        v = np.array(v)
        v[model.names.v.index("q1")] = 0.1
    M, G = model.mass_matrix(found.q, par=par), model.constraint_jacobian(found.q, par=par)
    after, impulse = np.asarray(found.v_after), np.asarray(found.impulse)
    dv = after - v
    matrix = np.block([[M, -G.T], [G, np.zeros((len(G), len(G)))]])
    wanted = np.linalg.lstsq(matrix, np.r_[M @ v, np.zeros(len(G))], rcond=1e-12)[0][: len(M)]
    size = float(np.abs(v).max())
    missed = float(np.abs(after - wanted).max()) / size
    missed = max(missed, float(np.abs(M @ dv - G.T @ impulse).max()) / (float(np.abs(M).max()) * size))
    if which != 2:
        missed = max(missed, abs(float(found.energy_lost) - float(0.5 * dv @ M @ dv)) / float(0.5 * v @ M @ v))
    return missed


def struck(_: Scene) -> Iterator[Cell]:
    """Bodies on a rail strike by a constraint, and rebound by Newton's coefficient; a ball bounces by an action."""
    masses = {"x": 1.0, "y": 3.0}
    rail = tuple(sf.RigidBody(n, sf.Joint(n, "prismatic", axis=(1, 0, 0)), sf.Inertia(m)) for n, m in masses.items())
    touch = sf.Closure("touch", ("x", None), ("y", None), ("x",))
    switches = (sf.Switch("touch", sf.formula("contact")),)
    system = sf.System("rail", rail, (sf.Parameter("contact", 0.0),), constraints=(touch,), switches=switches)
    model = sf.compile(system, _TAPE)
    for e in (0.05, 0.3, 1.0):
        events = {"strike": sf.Event("x - y", "rising", action={"contact": 1}, restitution=e)}
        run = sf.simulate(model, [-0.5, 0.0], [1.0, 0.0], 1.0, events=events, method="dopri5")
        met = run.events[0] if run.events else None
        if met is None or len(run.events) != 1:
            yield Cell(f"a strike at {e}", np.inf, LOCATED)
            continue
        wanted = np.array([0.5, 1.0 - 0.75 * (1 + e), 0.25 * (1 + e), 0.375 * (1 - e**2), 0.75 * (1 + e)])
        found = np.array([met.t, *np.asarray(met.v_after), met.energy_lost, abs(np.asarray(met.impulse)[0])])
        end = np.array([0.5 * wanted[1], 0.5 * wanted[2]])
        yield Cell(f"a strike at {e}", max(off(found, wanted), off(run.q[-1], end)), LOCATED)
    ball = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(sf.formula("m")))
    model = sf.compile(sf.System("bouncing", (ball,), (sf.Parameter("m", 2.0),), gravity=(0, 0, -10)), _TAPE)
    events = {"floor": sf.Event("z", "falling", action={"dz": "-0.5*dz", "m": "m/2"})}
    for method in ("rk4", "dopri5"):
        run = sf.simulate(model, [5.0], t_end=2.7, events=events, method=method, dt=0.01)
        times = np.array([one.t for one in run.events])
        yield Cell(f"bounces, {method}", off(times, np.array([1.0, 2.0, 2.5])), LOCATED)
        if len(times) == 3:
            rest = run.t[-1] - 2.5
            wanted = np.array([1.25 * rest - 5.0 * rest**2, 1.25 - 10.0 * rest, 0.25])
            yield Cell(
                f"after bounces, {method}",
                off(np.array([run.q[-1, 0], run.v[-1, 0], *run.par_over_time[-1]]), wanted),
                1e-6,
            )


def on_slide(*elements: Any, slope: float = 0.0, mass: float = 2.0, **fields: Any) -> sf.System:
    """A block that slides down a plane."""
    axis = (math.cos(slope), 0.0, -math.sin(slope))
    block = sf.RigidBody("block", sf.Joint("s", "prismatic", axis=axis, elements=elements), sf.Inertia(mass))
    return sf.System("on_slide", (block,), **fields)


def stuck(_: Scene) -> Iterator[Cell]:
    """Joints that stick: held to the last bit, sliding by closed forms, let go by a brake; alone and in batches."""
    weight = 2.0 * _G * math.sin(_SLOPE)
    for share in (1.001, 0.999):
        model = sf.compile(on_slide(sf.Friction(share * weight, sticks=True), slope=_SLOPE), _TAPE)
        run = sf.simulate(model, [0.7], t_end=0.5, dt=1e-2)
        wanted = np.array([0.7, 0.0]) if share > 1.0 else np.array([0.0, 0.5 * (1.0 - share) * weight / 2.0])
        found = np.array([run.q[-1, 0], run.v[-1, 0]]) if share > 1.0 else np.array([0.0, run.v[-1, 0]])
        lam = run.lam[-1, 0] + weight if share > 1.0 else 0.0
        yield Cell(f"on an incline, {share}", float(np.abs(found - wanted).max()) + abs(lam), 1e-12)
    stiffness, force = 100.0, 4.0
    system = on_slide(sf.Spring(stiffness), sf.Friction(force, sticks=True), mass=1.0)
    model, turns = sf.compile(system, _TAPE), 12
    amplitudes = 1.0 - 2.0 * force / stiffness * np.arange(1, turns + 1)
    wanted = np.r_[amplitudes * (-1.0) ** np.arange(1, turns + 1), np.pi / 10 * np.arange(1, turns + 1)]
    for method, options, bound in (("dopri5", {"rtol": 1e-11, "atol": 1e-13}, 1e-7), ("rk4", {"dt": 2e-3}, 1e-6)):
        given: dict[str, Any] = {"method": method, **options}
        run = sf.simulate(model, [1.0], t_end=4.0, **given)
        found = np.r_[[one.q[0] for one in run.events], [one.t for one in run.events]]
        names = [one.name for one in run.events] != ["s slides"] * (turns - 1) + ["s sticks"]
        yield Cell(f"dry oscillations, {method}", off(found, wanted) + float(names), bound)
        modes = run.par_over_time[:, model.names.par.index("s.mode")]
        yield Cell(
            f"dry oscillations, {method}: rest", float(modes[-1] != 2.0) + float(np.ptp(run.q[run.t > 3.8])), SAME
        )
        batch = sf.simulate_batch(model, [[1.0], [0.3], [-0.05]], t_end=4.0, output=1.0, **given)
        ends = [sf.simulate(model, [x], t_end=4.0, **given).q[-1] for x in (1.0, 0.3, -0.05)]
        yield Cell(f"dry oscillations, {method}, in a batch", off(batch.q_last, np.array(ends)), 1e-9)
    stepper = sf.Stepper(model, dt=2e-3, method="rk4")
    stepper.reset([1.0])
    stepper.step(steps=500)
    run = sf.simulate(model, [1.0], t_end=1.0, dt=2e-3, method="rk4")
    yield Cell("dry oscillations by hand", float(np.sum(stepper.q != run.q[-1])), SAME, "entries of other bits")
    with tempfile.TemporaryDirectory() as folder:
        sf.export(system, "c", folder, start={"s": 1.0}, method="rk4", dt=2e-3)
        lines = {
            words[0]: words[1:]
            for row in printed(Path(folder), "1.0", "2e-3", "--fast").splitlines()
            if (words := row.split())
        }
        yield Cell("dry oscillations as a package of C", off(np.array([float(lines["q"][0])]), run.q[-1]), 1e-8)
    yield from _braked()


def _braked() -> Iterator[Cell]:
    """A brake that opens and shuts: fall by the closed form, deceleration by its torque, rest; two joints at once."""
    parameters = (sf.Parameter("force", 30.0), sf.Parameter("shut", 1.0))
    brake = on_slide(sf.Brake("force", "shut"), slope=math.pi / 2, parameters=parameters)
    model = sf.compile(brake, _TAPE)
    events = {"open": sf.Event("t - 0.2", action={"shut": 0}), "shut": sf.Event("t - 0.5", action={"shut": 1})}
    run = sf.simulate(model, t_end=1.5, events=events, method="dopri5", rtol=1e-10, atol=1e-12)
    speed, slowing = 0.3 * _G, 15.0 - _G
    wanted = np.array([0.2, 0.5, 0.5 + speed / slowing, 0.045 * _G + 0.5 * speed**2 / slowing])
    sticks = [one.t for one in run.events if one.name == "s sticks"]
    found = np.array([*[one.t for one in run.events if one.name in ("open", "shut")], *sticks[-1:], run.q[-1, 0]])
    yield Cell("a brake", off(found, wanted) + float(run.v[-1, 0] != 0.0), LOCATED)
    pulled = sf.VirtualPower("motor", (("dx", sf.formula("motor")),))
    force = sf.Friction(6.0, static=9.0, viscous=0.4, sticks=True)
    bodies = (
        sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(force,)), sf.Inertia(1.0)),
        sf.RigidBody("y", sf.Joint("y", "prismatic", axis=(1, 0, 0), parent="x", elements=(force,)), sf.Inertia(2.0)),
    )
    model = sf.compile(sf.System("drive", bodies, inputs=(sf.Input("motor"),), virtual_power=(pulled,)), _TAPE)
    run = sf.simulate(model, t_end=1.0, u={"motor": "8 + 4*t"}, method="dopri5", rtol=1e-10, atol=1e-12)
    names, t = [one.name for one in run.events], np.array([one.t for one in run.events])
    c, m, s = 0.4, 3.0, float(run.t[-1]) - 0.25  # From 9 N on: m v' + c v = 3 + 4 s, both bodies as one.
    v = (3.0 - 4.0 * m / c) / c * (1.0 - math.exp(-c * s / m)) + 4.0 * s / c
    error = off(t, np.array([0.25])) + abs(run.v[-1, 0] - v) + abs(run.v[-1, 1]) + float(names != ["x slides"])
    yield Cell("a drive that lets go", error, LOCATED)
