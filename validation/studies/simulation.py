"""Motions, ours and the engines' at equal accuracy: how much faster than real time, and than they."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Annotated

import numpy as np
import typer

import symofros as sf

from .. import references
from ..accuracy.motion import spinup
from ..accuracy.reference import data
from ..adapters.exudyn.ancf import spin_up
from ..adapters.mujoco import motion as mujoco_motion
from ..adapters.mujoco import tree as mujoco
from ..contract.interface import Subject, Unsupported
from ..reporting.command import Run, known
from ..reporting.record import Data
from ..reporting.references import References
from ..stability.closed_loops import four_bars
from ..stability.closed_loops.singular import ends_of_crank
from ..stability.closed_loops.soft_closures import SOLIMP
from ..timing.models import panda7

# Of each joint [N m/rad, N m s/rad]: what RK4 with a millisecond holds at the wrist, whose inertia is the smallest.
STIFFNESS, DAMPING, TARGET = 20.0, 1.0, 0.4


@dataclass(frozen=True)
class TimedRun:
    """The timed motion of one side.

    Attributes:
        how: Method and step, in words.
        error: Distance to the reference, in the unit of the measure.
        seconds: Minimum and median over the repeats.
    """

    how: str
    error: float
    seconds: tuple[float, float]


@dataclass(frozen=True)
class Race:
    """One motion by the generated C and by an engine.

    Attributes:
        motion: Name of the motion.
        span: Seconds of motion.
        measure: Definition of the error, with the reference.
        generated: Run by the generated C.
        engine: Name of the engine; "" for none.
        engine_run: Run by the engine; None for none.
        ratio: Median over the repeats of the engine's time over that of the generated C; 0 without an engine.
    """

    motion: str
    span: float
    measure: str
    generated: TimedRun
    engine: str = ""
    engine_run: TimedRun | None = None
    ratio: float = 0.0

    @property
    def real_time(self) -> float:
        """Seconds of motion a second, at the fastest run of the generated C."""
        return self.span / self.generated.seconds[0]


def done(run: sf.Trajectory) -> sf.Trajectory:
    """A run that came to its end.

    Raises:
        ValueError: It did not, so its time means nothing.
    """
    if not run.outcome.ok:
        raise ValueError(f"{run.model.record.name}: {run.outcome}")
    return run


Timed = Callable[[], tuple[float, float]]  # -> error, seconds


def race(
    motion: str,
    span: float,
    measure: str,
    ours: tuple[str, Timed],
    repeats: int,
    other: tuple[str, str, Timed] | None = None,
) -> Race:
    """Run both sides in turn, so often."""
    times: tuple[list[float], list[float]] = ([], [])
    errors = [0.0, 0.0]
    sides = [ours[1], *([other[2]] if other else [])]
    for _ in range(repeats):
        for k, side in enumerate(sides):
            errors[k], seconds = side()
            times[k].append(seconds)
    summary = [(min(side), median(side)) if side else (0.0, 0.0) for side in times]
    generated = TimedRun(ours[0], errors[0], summary[0])
    if other is None:
        return Race(motion, span, measure, generated)
    ratio = median(b / a for a, b in zip(*times, strict=True))
    return Race(motion, span, measure, generated, other[0], TimedRun(other[1], errors[1], summary[1]), ratio)


def arm(repeats: int, span: float = 10.0, h: float = 1e-3) -> Race:
    """A 7-joint arm under PD control, by RK4 with steps of a millisecond on both sides.

    Raises:
        ValueError: MuJoCo can't hold the arm.
    """
    panda = panda7()
    bodies = [
        body if body.joint is None else replace(body, joint=replace(body.joint, elements=())) for body in panda.bodies
    ]
    system = replace(panda, bodies=tuple(bodies))
    m = sf.compile(system)
    engine = mujoco.build(Subject("panda7", system))
    if isinstance(engine, Unsupported):
        raise ValueError(f"MuJoCo: {engine.reason}")
    q0, v0, targets = m.neutral(), np.zeros(m.nv), np.full(m.nq, TARGET)
    joints = dict(zip(m.names.u, m.names.q, strict=True))
    law = {u: f"{STIFFNESS}*({TARGET} - {q}) - {DAMPING}*d{q}" for u, q in joints.items()}
    exact = done(sf.simulate(m, q0, v0, span, u=law, method="dop853", rtol=1e-12, atol=1e-12)).q[-1]

    def ours() -> tuple[float, float]:
        run = done(sf.simulate(m, q0, v0, span, u=law, method="rk4", dt=h, every=100))
        return float(np.abs(run.q[-1] - exact).max()), run.statistics.seconds

    def by_mujoco() -> tuple[float, float]:
        q, _, seconds = mujoco_motion.servo(engine, q0, v0, targets, STIFFNESS, DAMPING, h, round(span / h))
        return float(np.abs(q - exact).max()), seconds

    step = f"RK4, {1e3 * h:g} ms"
    return race(
        "panda, 7 joints, PD control",
        span,
        "joints at the end, against dop853 at 1e-12 [rad]",
        (step, ours),
        repeats,
        ("MuJoCo, mj_step", step, by_mujoco),
    )


def four_bar(repeats: int, span: float = 10.0) -> Race:
    """A four-bar through its singular posture twice a turn; MuJoCo's closures are soft."""
    m = four_bars.linkage(1)
    q, v = four_bars.state(m, *four_bars.START)
    h_ours, h_mujoco = 5e-3, 1e-4

    def ours() -> tuple[float, float]:
        run = done(sf.simulate(m, q, v, span, method="rk4", dt=h_ours, every=100))
        end = np.array([np.cos(run.q[-1, 0]), np.sin(run.q[-1, 0])])
        return float(four_bars.tip_error(1, span, end)), run.statistics.seconds

    def by_mujoco() -> tuple[float, float]:
        text = four_bars.mjcf(1, "RK4", h_mujoco, "0.002 1", SOLIMP)
        began = perf_counter()
        moved = mujoco_motion.move(text, np.zeros(m.nq), v, span, samples=1)
        return float(four_bars.tip_error(1, span, ends_of_crank(moved.q))), perf_counter() - began

    return race(
        "four-bar through its singular posture",
        span,
        "tip of the crank at the end, exact [m]",
        (f"RK4, {1e3 * h_ours:g} ms, projection", ours),
        repeats,
        ("MuJoCo, mj_step", f"RK4, {1e3 * h_mujoco:g} ms, stiff soft closures", by_mujoco),
    )


def planar_robot(repeats: int, span: float = 2.0, h: float = 1e-3) -> Race:
    """The paper's robot, friction and all, let go with turning joints."""
    m = sf.compile(references.MODELS["planar_robot"])
    v0 = np.zeros(m.nv)
    v0[[m.names.v.index(name) for name in ("q1", "q2", "q3")]] = 0.5, -0.8, 0.6
    exact = sf.simulate(m, None, v0, span, method="rodas4", rtol=1e-9, atol=1e-10).q[-1]

    def ours() -> tuple[float, float]:
        run = done(sf.simulate(m, None, v0, span, method="rk4", dt=h, every=100))
        return float(np.abs(run.q[-1] - exact).max()), run.statistics.seconds

    return race(
        "planar flexible robot with friction",
        span,
        "coordinates at the end, against rodas4 at 1e-9 [rad, m]",
        (f"RK4, {1e3 * h:g} ms", ours),
        repeats,
    )


def spinning_beam(
    repeats: int,
    span: float = 15.0,
    meshes: Sequence[tuple[int, float]] = ((2, 0.05), (4, 0.05), (4, 0.025), (8, 0.025), (8, 0.0125), (16, 0.0025)),
) -> Race:
    """Spin-up: three modes against the coarsest of Exudyn's meshes and steps that errs no more."""
    rod = data("spin_up")["exact_inextensible_rod"]
    times = np.array([t for t in rod["t"] if t <= span])
    exact = np.stack([rod["tip_x"], rod["tip_y"]], axis=-1)[: len(times)]
    hub = sf.Joint("hub", "revolute", prescribed=True)
    beam = sf.Beam("b", hub, spinup.LENGTH, spinup.RHO_A, EI_z=spinup.EI, bend_y=3, family="clamped_free")
    m = sf.compile(sf.System("spin_up", (beam,), gravity=(0, 0, 0)))
    k, rate = 2 * np.pi / spinup.END, spinup.RATE / spinup.END
    law = {
        "hub": f"{rate!r}*(t^2/2 + (cos({k!r}*t) - 1)/{k * k!r})",
        "dhub": f"{rate!r}*(t - sin({k!r}*t)/{k!r})",
        "ddhub": f"{rate!r}*(1 - cos({k!r}*t))",
    }

    def ours() -> tuple[float, float]:
        run = done(sf.simulate(m, t_end=span, u=law, method="rk4", dt=2e-2, output=times))
        c, s = np.cos(run["hub"]), np.sin(run["hub"])
        place = run.frames["tip"][0]
        tip = np.stack([c * place[:, 0] + s * place[:, 1] - spinup.LENGTH, c * place[:, 1] - s * place[:, 0]], axis=-1)
        return float(np.abs(tip - exact).max()), run.statistics.seconds

    def exudyn(elements: int, step: float) -> tuple[float, float]:
        began = perf_counter()
        t, tip = spin_up(elements, step, span, spinup.STRETCH)
        seconds = perf_counter() - began
        at = np.searchsorted(t, times - 1e-6)
        return float(np.abs(tip[np.minimum(at, len(t) - 1)] - exact).max()), seconds

    bound = ours()[0]
    chosen = next((mesh for mesh in meshes if exudyn(*mesh)[0] <= bound), meshes[-1])
    return race(
        "spin-up of a beam on a driven hub",
        span,
        "tip over the run, against the exact rod [m]",
        ("3 modes, RK4, 20 ms", ours),
        repeats,
        (
            "Exudyn, ANCFCable2D",
            f"{chosen[0]} elements, generalised alpha, {1e3 * chosen[1]:g} ms",
            lambda: exudyn(*chosen),
        ),
    )


@dataclass(frozen=True)
class Benchmark:
    """One of the multibody benchmarks of the IFToMM library.

    Attributes:
        name: Its name there.
        span: Seconds of motion.
        how: Method and tolerance or step.
        measure: What `error` is of.
        error: Found.
        threshold: The library's, or what the reference is good to.
        seconds: Wall time of the stepping, the least of the repeats.
    """

    name: str
    span: float
    how: str
    measure: str
    error: float
    threshold: float
    seconds: float


def iftomm(repeats: int) -> list[Benchmark]:
    """A01 to A05, each to its end; tests/reference/test_iftomm.py compares whole motions."""
    pendulum = sf.RigidBody("bob", sf.Joint("q", "revolute", axis=(0, -1, 0)), sf.Inertia(1.0, (1, 0, 0), (0, 0, 0)))
    governor = sf.compile(references.MODELS["flyball_governor"])
    bricard = sf.compile(references.MODELS["bricard"])
    andrews = sf.compile(references.MODELS["andrews_squeezer"])
    known = References(Path(__file__).parent / "data").data("iftomm")
    start = np.array([known["andrews"]["start"][name] for name in andrews.names.q])
    end = np.array([known["andrews"]["end"][name] for name in andrews.names.q])
    rows = known["four_bar_energy_J"], known["governor_slider_m"], known["bricard_q"]
    row = four_bars.linkage(2)
    places = four_bars.state(row, *four_bars.START)
    energy = "energy over the run [J]"

    def drift(run: sf.Trajectory) -> float:
        return float(np.abs(run.energy - run.energy[0]).max())

    cases: list[tuple[str, float, str, str, float, Callable[[], sf.Trajectory], Callable[[sf.Trajectory], float]]] = [
        (
            "A01 simple pendulum",
            10.0,
            "rk4, 5 ms",
            energy,
            known["pendulum_energy_J"],
            lambda: sf.simulate(sf.compile(sf.System("a01", (pendulum,))), [np.pi], t_end=10.0, dt=5e-3),
            drift,
        ),
        (
            "A02 two four-bars, singular twice a turn",
            10.0,
            "rk4, 5 ms, projection",
            energy,
            rows[0],
            lambda: sf.simulate(row, *places, 10.0, dt=5e-3, every=10),
            drift,
        ),
        (
            "A03 Andrews' squeezer",
            0.03,
            "dop853, 1e-10",
            "angles at 0.03 s, relative, IVP test set",
            1e-8,
            lambda: sf.simulate(andrews, start, t_end=0.03, method="dop853", rtol=1e-10, atol=1e-10),
            lambda run: float(np.abs(run.q[-1] / end - 1.0).max()),
        ),
        (
            "A04 Bricard, over-constrained",
            10.0,
            "rk4, 5 ms, projection",
            "coordinates at 10 s [rad]",
            1e-5,
            lambda: sf.simulate(bricard, t_end=10.0, dt=5e-3, every=100),
            lambda run: float(np.abs(run.q[-1] - rows[2]).max()),
        ),
        (
            "A05 flyball governor, stiff",
            10.0,
            "rodas4, 1e-6",
            "slider at 10 s [m]",
            1e-4,
            lambda: sf.simulate(
                governor,
                [0, np.pi / 6, np.pi / 6, 0.5],
                [2 * np.pi, 0, 0, 0],
                10.0,
                method="rodas4",
                rtol=1e-6,
                atol=1e-6,
            ),
            lambda run: abs(float(run["s"][-1]) - rows[1]),
        ),
    ]
    benchmarks = []
    for name, span, how, measure, threshold, move, judge in cases:
        runs = [done(move()) for _ in range(repeats)]
        seconds = min(run.statistics.seconds for run in runs)
        benchmarks.append(Benchmark(name, span, how, measure, judge(runs[-1]), threshold, seconds))
    return benchmarks


MOTIONS = {
    "arm": arm,
    "four_bar": four_bar,
    "planar_robot": planar_robot,
    "spinning_beam": spinning_beam,
}


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--motion", help=f"Only this: {', '.join(MOTIONS)}.")] = None,
    repeats: Annotated[int, typer.Option(min=1, help="Interleaved repeats.")] = 7,
) -> Data:
    """Time motions: times real time, and against MuJoCo and Exudyn at equal accuracy."""
    motions = known(chosen, MOTIONS, "--motion", "motion")
    run.expect(len(motions), "motions")
    races = []
    for name in motions:
        row = MOTIONS[name](repeats)
        races.append(asdict(row) | {"real_time": row.real_time})
        run.advance()
    benchmarks = [] if chosen else [asdict(row) for row in iftomm(repeats)]
    return {"races": races, "iftomm": benchmarks, "repeats": repeats}
