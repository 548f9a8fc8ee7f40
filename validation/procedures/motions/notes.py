"""What runs note of themselves: the notes that a motion must have, their numbers, and silence where nothing is wrong.

Bounds of stability and factors are those of the methods' polynomials; shares, times and energies are worked out here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

import symofros as sf

from ..machines import TAPE
from ..scene import Cell, Scene, off

# Notes round their numbers to three digits and more; a share to two.
_TOLD, SAME = 6e-3, 0.5


def _slide(*elements: Any, effort: str = "", limits: sf.Limits | None = None, **more: Any) -> sf.Model:
    efforts = (sf.formula(effort),) if effort else ()
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements, effort=efforts, limits=limits)
    body = sf.RigidBody("block", joint, sf.Inertia(1.0))
    return sf.compile(sf.System("slide", (body,), gravity=(0, 0, 0), **more), TAPE)


def _tied_ball(w: float) -> sf.Model:
    """A body on a ball joint, on springs by which it oscillates at w about x and y; it does not turn about z."""
    springs = tuple(sf.formula(f"-{2 * w**2}*r.q{axis}") for axis in "xyz")
    body = sf.RigidBody("body", sf.Joint("r", "ball", effort=springs), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    return sf.compile(
        sf.System("tied", (body,), constraints=(sf.Coupling("tie", sf.formula("r.qz")),), gravity=(0, 0, 0)), TAPE
    )


def _pendulum() -> sf.Model:
    hinge = sf.Joint("q", "revolute", axis=(0, 1, 0))
    return sf.compile(sf.System("pendulum", (sf.RigidBody("bob", hinge, sf.Inertia(1.0, (0, 0, -1.0))),)), TAPE)


def _notes_cell(name: str, run: sf.Trajectory, *expected: tuple[str, tuple[float, ...]]) -> Cell:
    """The cell of a run: each expected note is there with its numbers, and no other.

    Args:
        name: What was run.
        run: The run.
        expected: Patterns of its notes, a group a number; with the numbers.
    """
    notes, worst = list(run.outcome.notes), float(run.outcome.kind != "finished")
    for pattern, numbers in expected:
        found = next((match for note in notes if (match := re.search(pattern, note))), None)
        if found is None:
            return Cell(f"notes: {name}", math.inf, _TOLD, f"none says '{pattern}'")
        notes.remove(found.string)
        if numbers:
            worst = max(worst, off(np.array([float(x) for x in found.groups()]) / numbers, np.ones(len(numbers))))
    return Cell(f"notes: {name}", worst + len(notes), _TOLD, "; ".join(notes))


_NUMBER = r"(-?[\d.]+(?:e[+-]?\d+)?)"


def on_steps(_: Scene) -> Iterator[Cell]:
    """Steps beyond stability, too long, too coarse; the same motions by shorter steps say nothing."""
    w, h = 400.0, 0.01
    z = 1j * w * h
    factor = abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)
    beyond = (
        rf"'rk4' is stable up to {_NUMBER} s for .* oscillates at {_NUMBER} rad/s .* multiplies it by {_NUMBER} each"
    )
    turned = [1e-3, 0.0, 0.0, math.sqrt(1.0 - 1e-6)]
    for of, stiff, q in (("", _slide(sf.Spring(w**2)), [1.0]), (" of a ball that is tied", _tied_ball(w), turned)):
        run = sf.simulate(stiff, q, t_end=0.5, dt=h, method="rk4")
        yield _notes_cell(f"a step{of} beyond stability", run, (beyond, (2 * math.sqrt(2) / w, w, factor)))
        yield _notes_cell(f"a step{of} within it", sf.simulate(stiff, q, t_end=0.1, dt=5e-4, method="rk4"))
    pendulum = _pendulum()
    run = sf.simulate(pendulum, [1.0], t_end=2.0, dt=0.02, method="euler")
    appeared = float(run.energy[-1] - run.energy[0])
    yield _notes_cell(
        "a method that feeds", run, (rf"'euler' is stable at no step .*; {_NUMBER} J appeared", (appeared,))
    )
    run = sf.simulate(pendulum, [1.0], t_end=60.0, dt=0.1, method="euler")
    found = [one for one in run.outcome.notes if "energy changes by" in one]
    gained = float(np.ptp(run.energy))
    noted = [float(one) for note in found for one in re.findall(rf"energy changes by {_NUMBER} J", note)]
    yield Cell("notes: energy that nobody gives", off(np.array(noted), np.array([gained])), 0.05)
    run = sf.simulate(pendulum, [3.1], t_end=6.0, dt=0.25, method="rk4")
    yield _notes_cell("steps that decide", run, (r"steps of 0.25 s do not determine the motion: half of that", ()))
    fine = sf.simulate(pendulum, [3.1], t_end=6.0, dt=0.01, method="rk4")
    yield _notes_cell("steps that do not", fine)
    loose = sf.simulate(pendulum, [3.1], t_end=6.0, method="dopri5", rtol=0.3, atol=0.3)
    said = any("tolerances" in note or "passes over" in note for note in loose.outcome.notes)
    yield Cell("notes: loose tolerances", float(not said), SAME, "; ".join(loose.outcome.notes))
    yield _notes_cell(
        "tight tolerances", sf.simulate(pendulum, [3.1], t_end=6.0, method="dopri5", rtol=1e-8, atol=1e-9)
    )
    spring = _slide(sf.Spring(4.0))
    run = sf.simulate(spring, [1e-3], t_end=5.0, method="dopri5", rtol=1e-6, atol=0.1)
    over = r"the step from t = .* passes over what acts within it: steps of .* change the motion there .*max_step"
    yield _notes_cell("a step that passes over", run, (over, ()))


def on_inputs(_: Scene) -> Iterator[Cell]:
    """Inputs and forces by time that change within steps, and those that change at their ends."""
    driven = _slide(effort="F", inputs=(sf.Input("F"),))
    for kind, made in (("hold", 10.0 * 4 / 6), ("linear", 10.0 * 4 / 6)):
        samples = sf.Signal([0.0, 0.05, 0.06, 1.0], [0.0, 100.0, 0.0, 0.0], kind)  # type: ignore[arg-type]
        exact = 1.0 if kind == "hold" else 0.5 * 0.06 * 100.0
        run = sf.simulate(driven, [0.0], t_end=1.0, dt=0.1, u={"F": samples}, method="rk4")
        missed = abs(made - exact)
        noted = [float(x) for note in run.outcome.notes for x in re.findall(rf"impulse is off by {_NUMBER},", note)]
        yield Cell(f"notes: samples within steps, {kind}", off(np.array(noted), np.array([missed])), _TOLD)
    samples = sf.Signal([0.0, 0.1, 0.2, 1.0], [0.0, 100.0, 0.0, 0.0], "hold")
    yield _notes_cell("samples at steps", sf.simulate(driven, [0.0], t_end=1.0, dt=0.1, u={"F": samples}, method="rk4"))
    late = sf.Signal([0.0, 0.05, 0.55], [0.0, 1.0, -1.0], "hold")
    run = sf.simulate(driven, [0.0], t_end=1.0, dt=0.1, u={"F": late}, method="rk4")
    said = any("misjudge" in note for note in run.outcome.notes)
    yield Cell("notes: samples that come late by less than a step", float(said), SAME, "; ".join(run.outcome.notes))
    pulsed = _slide(effort="1000*exp(-((t - 0.2525)/0.0005)^2)")
    run = sf.simulate(pulsed, [0.0], [1.0], t_end=0.5, dt=0.01, method="rk4")
    given = 1000 * 5e-4 * math.sqrt(math.pi)
    pattern = rf"misjudge forces by formulas of time, .*: at t = {_NUMBER} s .* are off by {_NUMBER} %"
    yield _notes_cell("a force within steps", run, (pattern, (0.26, 100 * given / 1.0)))
    smooth = _slide(effort="10*exp(-((t - 0.25)/0.1)^2)")
    yield _notes_cell("a force of many steps", sf.simulate(smooth, [0.0], [1.0], t_end=0.5, dt=0.01, method="rk4"))


def on_motions(_: Scene) -> Iterator[Cell]:
    """Limits that are left, joints that creep, postures that are singular; each by its numbers."""
    limited = _slide(limits=sf.Limits(-1.0, 1.0, velocity=2.0))
    run = sf.simulate(limited, [0.0], [3.0], t_end=1.0, dt=0.1)
    places = rf"'x' leaves its limits, -1 to 1, at t = {_NUMBER} s, by up to {_NUMBER}:"
    speeds = rf"the speed of 'x' exceeds its limits, {_NUMBER} to {_NUMBER}, at t = [\d.]+ s, by up to {_NUMBER}:"
    yield _notes_cell("limits that are left", run, (places, (0.4, 2.0)), (speeds, (-2.0, 2.0, 1.0)))
    yield _notes_cell("limits that are kept", sf.simulate(limited, [0.0], [0.5], t_end=1.0, dt=0.1))
    driven = sf.simulate(_slide(sf.Damper(-2.0)), [0.0], [1.0], t_end=10.0, dt=1e-3, method="rk4")
    yield _notes_cell("speeds that a force drives", driven)
    yield Cell("growth by a force", float(driven.v[-1, 0] / math.exp(20.0)) - 1.0, 1e-6)
    creeping = _slide(sf.Friction(1.0, minimum_velocity=1e-3), effort="0.5")
    run = sf.simulate(creeping, [0.0], t_end=1.0, dt=1e-3)
    said = rf"'x' ends at {_NUMBER}, where friction carries {_NUMBER} of the {_NUMBER} that it reaches"
    yield _notes_cell("a joint that creeps", run, (said, (float(run.v[-1, 0]), 0.5, 1.0)))
    flat = _parallelogram()
    run = sf.simulate(flat, [0.3, -0.3, 0.3], [-2.0, 2.0, -2.0], t_end=0.4, dt=1e-3)
    passed = [
        float(t) for note in run.outcome.notes for t in re.findall(rf"singular posture .* at t = {_NUMBER} s", note)
    ]
    at = float(np.interp(0.0, -run.q[:, 0], run.t))
    yield Cell("notes: a singular posture", off(np.array(passed), np.array([at])), 0.02, "; ".join(run.outcome.notes))
    away = sf.simulate(flat, [1.3, -1.3, 1.3], [-0.2, 0.2, -0.2], t_end=0.1, dt=1e-3)
    yield _notes_cell("a regular posture", away)


def _parallelogram() -> sf.Model:
    """Two cranks of a metre and a coupler, which are in line at zero angles."""

    def link(name: str, joint: sf.Joint, length: float) -> sf.RigidBody:
        rod = sf.Inertia(length, (length / 2, 0, 0), (0.01, length**3 / 12, length**3 / 12))
        return sf.RigidBody(name, joint, rod, (sf.Frame("end", (length, 0, 0)),))

    hinges = (
        sf.Joint("q1", "revolute", axis=(0, 0, 1)),
        sf.Joint("q2", "revolute", "crank", "end", axis=(0, 0, 1)),
        sf.Joint("q3", "revolute", position=(2.0, 0, 0), axis=(0, 0, 1)),
    )
    bodies = tuple(map(link, ("crank", "coupler", "rocker"), hinges, (1.0, 2.0, 1.0)))
    shut = sf.Closure("shut", ("rocker", "end"), ("coupler", "end"), ("x", "y"))
    return sf.compile(sf.System("flat", bodies, gravity=(0, 0, 0), constraints=(shut,)), TAPE)
