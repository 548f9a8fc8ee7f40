"""Runs of ours against the same runs repeated: steps fixed and chosen, records, events, inputs, stabilisation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import symofros as sf
from symofros.tools import METHODS

from ...mechanics.geometry import Array
from ...mechanics.rod import StrainRod
from ..scene import Cell, Scene, off
from .steps import STEPS, Path, alpha_run, repeated_run, variational_run

# Rounding of some ten steps; where a Jacobian is of finite differences, what these leave; where steps are chosen by an
# estimate, a relative rounding of the estimate moves each end a little.
EXACT, DIFFERENCED, CHOSEN, DIFFERENCED_STEPS = 1e-10, 1e-6, 1e-6, 1e-4
T0, T_END, STEP = 0.25, 0.4, 0.02
TURN = 0.09  # Series of rotations hold up to 0.1 rad.
TOLERANCES = {"dopri5": 1e-4, "dop853": 1e-7, "rodas4": 1e-4}
IMPLICIT = ("implicit_euler", "rodas4")
# Lengths [m] and masses [kg] at which a mechanism moves as at one metre and one kilogram, in its own units of time.
SCALES = ((1e-4, 1e-5), (1e-6, 1e-9), (1e-3, 1e6), (1e3, 1e-6))
# Sections are placed so that a tip errs least: its share of the largest error along a rod that bends by a half to two
# radians is 0.005 to 0.03 where there are four.
TIP_SHARE = 1e-3
# Solvers of variable order err by their own estimates: what they are off by, over the tolerance.
MULTISTEP = 300.0


def fixed_steps(scene: Scene) -> Iterator[Cell]:
    """Each method with fixed steps."""
    for name in STEPS:
        adaptive = False if METHODS[name].adaptive else None
        run = sf.simulate(
            scene.model, scene.q, scene.v, T_END, u=scene.u, method=name, dt=STEP, t0=T0, adaptive=adaptive
        )
        tolerance = DIFFERENCED if name in IMPLICIT else EXACT
        yield Cell(f"steps by {name}", _off(scene, run, repeated_run(scene, name, T0, T_END, STEP)), tolerance)


def implicit_steps(scene: Scene) -> Iterator[Cell]:
    """Generalised alpha, and the variational rule where nothing is constrained."""
    # Steps that turn by nearly what series are for: their last terms are above what is left of solutions.
    turns = scene.manifold.nq != scene.manifold.nv
    steps, h = 4, TURN / float(np.linalg.norm(scene.v)) if turns else STEP
    for name, reference in (("generalized_alpha", alpha_run), ("variational", variational_run)):
        if name == "variational" and scene.model.nc:
            continue
        run = sf.simulate(scene.model, scene.q, scene.v, steps * h, u=scene.u, method=name, dt=h)
        q, v = reference(scene, h, steps)
        # MINPACK's solution is good to 1e-13 of the accelerations, whose steps count h^2.
        yield Cell(f"steps by {name}", _worst((run.q, q), (run.v, v)), 1e-8)


def scaled_steps(scene: Scene, lengths: tuple[tuple[int, ...], tuple[int, ...]]) -> Iterator[Cell]:
    """Steps at other scales equal the harness's at one metre and one kilogram, in units of sqrt(L/g).

    Args:
        scene: Model whose parameters are its mass and its length, both 1, and its first state.
        lengths: Indices of the coordinates and of the speeds that are lengths; the others are angles, quaternions.
    """
    still = replace(scene, law=lambda *_: np.zeros(scene.model.nu), u=None)
    on_q, on_v = np.ones(scene.model.nq), np.ones(scene.model.nv)
    for name in IMPLICIT:
        path = repeated_run(still, name, 0.0, 4 * STEP, STEP)
        worst = 0.0
        for L, m in SCALES:
            on_q[list(lengths[0])] = on_v[list(lengths[1])] = L
            unit = np.sqrt(L)
            run = sf.simulate(
                scene.model.with_parameters(m=m, **{scene.model.names.par[1]: L}),
                scene.q * on_q,
                scene.v * on_v / unit,
                4 * STEP * unit,
                method=name,
                dt=STEP * unit,
                adaptive=False if METHODS[name].adaptive else None,
            )
            q, v = scene.manifold.same_sign(run.q / on_q, path.q), run.v * unit / on_v
            worst = max(worst, _worst((run.t / unit, path.t), (q, path.q), (v, path.v)) + float(not run.outcome.ok))
        # The partial derivative by time is a forward difference over a span that is none of the scene's times: what
        # rounding of accelerations leaves over it is 1.1e-6 by implicit_euler at 1 km, with steps 30 times as long.
        yield Cell(f"steps by {name} at other scales", worst, 3.0 * DIFFERENCED)


def chosen_steps(scene: Scene) -> Iterator[Cell]:
    """Methods that choose their steps, with records on a grid along their dense output, and without."""
    for name, tolerance in TOLERANCES.items():
        if name == "rodas4" and scene.manifold.nq != scene.manifold.nv:
            continue  # Its estimate by Jacobians of finite differences chooses other steps.
        both: dict[str, Any] = {"rtol": tolerance, "atol": 0.1 * tolerance}
        path = repeated_run(scene, name, T0, T_END, 0.0, (tolerance, 0.1 * tolerance))
        given: dict[str, Any] = {"u": scene.u, "method": name, "t0": T0, **both}
        run = sf.simulate(scene.model, scene.q, scene.v, T_END, **given)
        bound = DIFFERENCED_STEPS if name in IMPLICIT else CHOSEN
        yield Cell(f"steps chosen by {name}", _off(scene, run, path), bound)
        grid = np.array([T0, 0.2617, 0.3, 0.3511, T_END])
        run = sf.simulate(scene.model, scene.q, scene.v, T_END, output=grid, **given)
        states = [path.within(t) for t in grid]
        yield Cell(f"records within steps of {name}", _off_states(scene, run, grid, states), bound)


def records(scene: Scene) -> Iterator[Cell]:
    """Which steps are recorded, on a grid within fixed steps, and where a bound ends the run or the step."""
    path = repeated_run(scene, "rk4", T0, T_END, STEP)
    given: dict[str, Any] = {"u": scene.u, "method": "rk4", "dt": STEP, "t0": T0}
    run = sf.simulate(scene.model, scene.q, scene.v, T_END, every=3, **given)
    kept = sorted({*range(0, len(path.t), 3), len(path.t) - 1})
    yield Cell("every third step", _off_states(scene, run, path.t[kept], [(path.q[i], path.v[i]) for i in kept]), EXACT)
    run = sf.simulate(scene.model, scene.q, scene.v, T_END, output=0.013, **given)
    grid = np.asarray(T0 + 0.013 * np.arange(12), dtype=np.float64)
    yield Cell("a grid", _off_states(scene, run, grid, [path.within(t) for t in grid]), EXACT)
    run = sf.simulate(scene.model, scene.q, scene.v, T_END, max_steps=3, **given)
    yield Cell("no more steps than asked for", off(run.t, path.t[:4]) + float(run.outcome.kind != "interrupted"), EXACT)
    free = sf.simulate(scene.model, scene.q, scene.v, T_END, method="dopri5", rtol=1e-2, atol=1e-2)
    short = sf.simulate(scene.model, scene.q, scene.v, T_END, method="dopri5", rtol=1e-2, atol=1e-2, max_step=0.01)
    longest = float(np.diff(short.t).max()) / 0.01 - 1.0
    yield Cell("longest step", abs(longest) + float(np.diff(free.t).max() < 0.02), 1e-9)


def events(scene: Scene, formulas: Mapping[str, sf.Event], values: Mapping[str, int]) -> Iterator[Cell]:
    """Zeros of coordinates along the path: times, states, directions, and where a terminal one ends the run.

    Args:
        scene: Model and first state.
        formulas: Events, each the coordinate of `values` less a number that its name ends with.
        values: Name of an event -> index of its coordinate.
    """
    for method, tolerances in (("dopri5", (1e-4, 1e-5)), ("rk4", (0.0, 0.0))):
        t_end = 2.0
        path = repeated_run(scene, method, 0.0, t_end, 0.0 if tolerances[0] else 0.05, tolerances)
        met = sorted(
            (t, name) for name, event in formulas.items() for t in _zeros(path, values[name], _level(name), event.sign)
        )
        stop = next((i for i, (_, name) in enumerate(met) if formulas[name].terminal), len(met) - 1)
        met = met[: stop + 1]
        options: dict[str, Any] = {"rtol": tolerances[0], "atol": tolerances[1]} if tolerances[0] else {"dt": 0.05}
        run = sf.simulate(scene.model, scene.q, scene.v, t_end, u=scene.u, method=method, events=formulas, **options)
        error = float("inf")
        if [one.name for one in run.events] == [name for _, name in met]:
            states = [path.within(t) for t, _ in met]
            error = _worst(
                ([one.t for one in run.events], [t for t, _ in met]),
                ([one.q for one in run.events], [q for q, _ in states]),
                ([one.v for one in run.events], [v for _, v in states]),
            )
            if met and formulas[met[-1][1]].terminal:
                error = max(error, _worst(([run.t[-1]], [met[-1][0]]), (run.q[-1], states[-1][0])))
                error += float(run.outcome.kind != "event")
        yield Cell(f"events by {method}", error, CHOSEN, f"{len(met)} events")


def _level(name: str) -> float:
    return float(name.rpartition(" ")[2])


def _zeros(path: Path, index: int, level: float, sign: int) -> Iterator[float]:
    for start, end, before, after in zip(
        path.t[:-1], path.t[1:], path.q[:-1, index] - level, path.q[1:, index] - level, strict=True
    ):
        rises, falls = before < 0.0 <= after, before > 0.0 >= after
        if (rises and sign >= 0) or (falls and sign <= 0):
            yield float(brentq(lambda t: path.within(t)[0][index] - level, start, end, xtol=1e-15, rtol=1e-15))


def stabilised(scene: Scene) -> Iterator[Cell]:
    """Constraints kept by gains, by those of a step's length, and not at all."""
    away = scene.manifold.retract(scene.q, np.full(scene.model.nv, 1e-3))
    cases: tuple[tuple[Any, dict[str, Any], tuple[float, float], float], ...] = (
        ("baumgarte", {"gains": (5.0, 7.0)}, (5.0, 7.0), 0.02),
        ("baumgarte", {}, (10.0, 10.0), 0.05),
        ("baumgarte", {}, (20.0, 20.0), 0.01),
        ("none", {}, (0.0, 0.0), 0.02),
    )
    for kind, given, gains, h in cases:
        q = away if kind == "baumgarte" else scene.q
        freed = replace(scene, q=q, gains=gains, projects=False)
        run = sf.simulate(scene.model, q, scene.v, 0.1, u=scene.u, method="rk4", dt=h, stabilisation=kind, **given)
        name = f"stabilisation {kind} {'' if not given else given['gains']} at {h:g} s"
        yield Cell(name, _off(freed, run, repeated_run(freed, "rk4", 0.0, 0.1, h)), EXACT)


def multistep(scene: Scene, methods: tuple[str, ...]) -> Iterator[Cell]:
    """SUNDIALS' methods against a tight run, and how their error follows the tolerance."""
    exact = sf.simulate(scene.model, scene.q, scene.v, 0.5, u=scene.u, method="dop853", rtol=1e-12, atol=1e-13)
    for name in methods:
        keeps: dict[str, Any] = {"stabilisation": "baumgarte"} if scene.model.nc and name != "ida" else {}
        for tolerance in (1e-4, 1e-8):
            given: dict[str, Any] = {"u": scene.u, "method": name, "rtol": tolerance, "atol": tolerance, **keeps}
            run = sf.simulate(scene.model, scene.q, scene.v, 0.5, output=[0.1, 0.3, 0.5], **given)
            error = _worst((run.q[-1], exact.q[-1]), (run.v[-1], exact.v[-1])) + float(not run.outcome.ok)
            yield Cell(f"{name} at {tolerance:g}", error, MULTISTEP * tolerance)


def small_turns(scene: Scene) -> Iterator[Cell]:
    """Steps in which a top turns by less than a milliradian about an axis that changes: series hold, no closed form."""
    lying = np.array([0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)])  # Its axis is level, so that weight turns it.
    at_rest = replace(scene, q=lying, v=np.array([0.3, 0.0, 0.1]))
    for name in ("rk4", "dop853"):
        adaptive = False if METHODS[name].adaptive else None
        run = sf.simulate(scene.model, lying, at_rest.v, 3e-3, method=name, dt=3e-3, adaptive=adaptive)
        yield Cell(f"small turns by {name}", _off(at_rest, run, repeated_run(at_rest, name, 0.0, 3e-3, 3e-3)), 2e-14)


def turned(_scene: Scene) -> Iterator[Cell]:
    """A free body moved by constant twists, by the exponential of screws: where series hold, and beyond."""
    body = sf.RigidBody("body", sf.Joint("root", "free"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    model = sf.compile(sf.System("turned", (body,), gravity=(0, 0, 0)))
    rng, errors = np.random.default_rng(7), np.zeros(3)
    for angle in (1e-4, 0.02, 0.099, 0.101, 0.5, 2.5):
        q, v = model.random_state(rng)
        v[3:] *= angle / np.linalg.norm(v[3:])
        moved = _place(q) @ expm(np.block([[_cross_matrix(v[3:]), v[:3, None]], [np.zeros((1, 4))]]))
        step = sf.simulate(model, q, v, 1.0, method="euler", dt=1.0).q[-1]
        whole, beside = model.integrate(q, v), moved.copy()
        beside[:3, 3] = q[:3] + _place(q)[:3, :3] @ v[:3]  # The chart of steps moves places along straight lines.
        found = (off(_place(whole), moved), off(_place(step), beside), off(model.difference(q, whole), v))
        errors = np.maximum(errors, found)
    names = ("places moved by twists", "one step of a free body", "twists between places")
    for name, error in zip(names, errors, strict=True):
        yield Cell(name, float(error), 1e-12)


def _cross_matrix(w: Array) -> Array:
    return np.cross(np.eye(3), w)


def _place(q: Array) -> Array:
    """The homogeneous matrix (4, 4) of a free body."""
    return np.block([[Rotation.from_quat(q[3:]).as_matrix(), q[:3, None]], [np.eye(4)[3:]]])


def mirrored(scene: Scene) -> Iterator[Cell]:
    """A motion of a pendulum and its mirror image bend their beams by the same amounts."""
    hanging = np.eye(scene.model.nq)[0] * np.pi / 2
    runs = [
        sf.simulate(
            scene.model, hanging + s * scene.q, s * scene.v, 0.02, method="rodas4", rtol=1e-5, atol=1e-8, output=0.01
        )
        for s in (1, -1)
    ]
    slopes = [[x for one in run.bendings for x in (one.slope, one.error)] for run in runs]
    yield Cell("a mirrored motion", off(runs[1].q - hanging, hanging - runs[0].q), 1e-6)
    error = off(np.array(slopes[1]), np.array(slopes[0]))
    yield Cell("bending of a mirrored motion", error + float(not slopes[0]), 1e-6)


def stated_error(scene: Scene) -> Iterator[Cell]:
    """A rod's stated error covers its tip's error against quadrature, and is at most 1/TIP_SHARE times it."""
    described = scene.system.bodies[0]
    assert isinstance(described, sf.Beam)
    rod = StrainRod(described, scene.system.parameter_values())
    worst = 0.0
    for size in (0.5, 1.0, 2.0):
        q = size * np.array([0.0, 1.0, 0.6, -0.5])
        run = sf.simulate(scene.model, q, 0.0 * scene.v, 1e-6, method="rk4", dt=1e-6)
        exact = rod.axis(np.array([rod.length]), q[None, 1:], 0.0 * q[None, 1:]).value[0, 0]
        share = float(np.linalg.norm(scene.model.frame_pose("tip", q)[0] - exact)) / rod.length / run.bendings[0].error
        worst = max(worst, share - 1.0, TIP_SHARE - share)
    yield Cell("stated error of a rod", max(0.0, worst), EXACT)


def pace(scene: Scene) -> Iterator[Cell]:
    """Inputs by formula, by samples and by a Python function are the same inputs."""
    names = scene.model.names.u
    t = np.linspace(0.0, 1.0, 9)
    samples = np.outer(np.sin(3 * t), np.arange(1, len(names) + 1))

    def called(at: float, _q: Array, _v: Array) -> Array:
        return np.array([np.interp(at, t, column) for column in samples.T])

    runs = [
        sf.simulate(scene.model, scene.q, scene.v, 0.4, u=u, method="rk4", dt=STEP)
        for u in (
            called,
            sf.Signal(t, samples),
            {name: sf.Signal(t, samples[:, i]) for i, name in enumerate(names)},
        )
    ]
    wanted = np.array([called(at, scene.q, scene.v) for at in runs[0].t])
    for run, kind in zip(runs, ("a function", "a signal of all", "signals by name"), strict=True):
        yield Cell(f"inputs by {kind}", _worst((run.u, wanted), (run.v, runs[0].v)), EXACT)


def _off(scene: Scene, run: sf.Trajectory, path: Path) -> float:
    if run.q.shape != path.q.shape:
        return float("inf")
    u = np.array([scene.law(t, q, v) for t, q, v in zip(path.t, path.q, path.v, strict=True)])
    return _worst(
        (run.t, path.t), (scene.manifold.same_sign(run.q, path.q), path.q), (run.v, path.v), (run.u, u)
    ) + float(not run.outcome.ok)


def _off_states(scene: Scene, run: sf.Trajectory, t: Array, states: list[tuple[Array, Array]]) -> float:
    q, v = np.array([q for q, _ in states]), np.array([v for _, v in states])
    if run.q.shape != q.shape:
        return float("inf")
    return _worst((run.t, t), (scene.manifold.same_sign(run.q, q), q), (run.v, v))


def _worst(*pairs: tuple[object, object]) -> float:
    return max(off(np.asarray(ours), np.asarray(reference)) for ours, reference in pairs)
