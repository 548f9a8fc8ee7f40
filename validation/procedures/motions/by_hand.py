"""Steps that a caller makes, inputs that are held, instants at the ends of steps, and balances of what a step keeps."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import util
from typing import Any, Literal

import numpy as np

import symofros as sf

from ...mechanics.geometry import Array
from ..scene import Cell, Scene, off

# The same steps; where they are divided otherwise, their rounding.
SAME, ROUNDING = 0.5, 1e-11
STEP, STEPS = 0.01, 12
# Motions stepped together: whole vectors of any width, and some behind them.
MOTIONS = 11
TURNS = 90
# Newton's method of an implicit step stops at some 1e-10 of its length.
REVERSED = 1e-7


def stepped(scene: Scene) -> Iterator[Cell]:
    """Steps by hand, of one motion and of several, are those of runs with the same held inputs."""
    model, rng = scene.model, np.random.default_rng(9)
    u = rng.standard_normal((MOTIONS, STEPS, model.nu))
    v = scene.v * np.linspace(0.5, 1.5, MOTIONS)[:, None]
    t = STEP * np.arange(STEPS)

    def run(k: int, method: str) -> sf.Trajectory:
        held = sf.Signal(t, u[k], "hold") if model.nu else None
        return sf.simulate(model, scene.q, v[k], STEPS * STEP, u=held, method=method, dt=STEP)

    for method in ("euler", "rk4"):
        stepper = sf.Stepper(model, method=method, dt=STEP)
        several = sf.Steppers(model, MOTIONS, method=method, dt=STEP)
        differing, error, largest = 0, 0.0, 0.0
        for k in (2, 5):  # The second time after another motion.
            stepper.reset(scene.q, v[k])
            for i, row in enumerate(u[k]):
                stepper.step(row)
                if i % 5 == 2:  # What is asked for on the way takes nothing from what is asked for at the end.
                    stepper.trajectory()
            wanted = run(k, method)
            differing += int(np.sum(stepper.q != wanted.q[-1]) + np.sum(stepper.v != wanted.v[-1]))
            made = stepper.trajectory()
            largest = max(largest, off(made.t, wanted.t), off(made.q, wanted.q), off(made.u[:-1], wanted.u[:-1]))
        several.reset(scene.q, v)
        for i in range(0, STEPS, 3):
            several.step(u[:, i], 1)
            several.step(u[:, i + 1])
            several.step(u[:, i + 2])
        for k in (0, 3, 7, 8, MOTIONS - 1):
            wanted = run(k, method)
            error = max(error, off(several.q[k], wanted.q[-1]), off(several.v[k], wanted.v[-1]))
        yield Cell(f"steps by hand, {method}", float(differing), SAME, "entries of other bits")
        yield Cell(f"trajectory of steps by hand, {method}", largest, ROUNDING)
        yield Cell(f"steps of {MOTIONS} motions by hand, {method}", error, ROUNDING)
    adaptive = sf.Stepper(model, method="dopri5", dt=0.05, rtol=1e-10, atol=1e-12)
    adaptive.reset(scene.q, scene.v)
    for _ in range(4):
        adaptive.step(u[0, 0])
    named = dict(zip(model.names.u, u[0, 0], strict=True))
    whole = sf.simulate(model, scene.q, scene.v, 0.2, u=named, method="dop853", rtol=1e-12, atol=1e-13)
    yield Cell("steps by hand, dopri5", max(off(adaptive.q, whole.q[-1]), off(adaptive.v, whole.v[-1])), 1e-7)


def held(scene: Scene) -> Iterator[Cell]:
    """Samples that hold until the next are constants of runs in a row, whichever way the instants are rounded."""
    model, period = scene.model, 0.05
    values = np.random.default_rng(10).standard_normal((5, model.nu))
    instants = {
        "products": period * np.arange(5),
        "sums": np.cumsum([0.0, *[period] * 4]),
        "divided": np.linspace(0.0, 4 * period, 5),
    }
    for method, options in _METHODS.items():
        q, v = scene.q, scene.v
        for row in values[:-1]:
            given = dict(zip(model.names.u, map(float, row), strict=True))
            piece = sf.simulate(model, q, v, period, u=given, method=method, **options)
            q, v = piece.q[-1], piece.v[-1]
        error = 0.0
        for t in instants.values():
            run = sf.simulate(
                model, scene.q, scene.v, 4 * period, u=sf.Signal(t, values, "hold"), method=method, **options
            )
            error = max(error, off(run.q[-1], q), off(run.v[-1], v))
        yield Cell(f"held samples by {method}", error, 1e-7 if "rtol" in options else ROUNDING)


_METHODS: dict[str, dict[str, Any]] = {
    "euler": {"dt": 0.025},
    "semi_implicit_euler": {"dt": 0.025},
    "rk4": {"dt": 0.05},
    "rodas4": {"dt": 0.025, "adaptive": False},
    "implicit_euler": {"dt": 0.025},
    "generalized_alpha": {"dt": 0.025},
    "variational": {"dt": 0.025},
    "dopri5": {"rtol": 1e-10, "atol": 1e-12},
    "dop853": {"rtol": 1e-10, "atol": 1e-12},
}


_CROSSINGS: tuple[tuple[str, Literal["rising", "falling", "both"]], ...] = (
    ("t - 0.5", "rising"),
    ("0.5 - t", "falling"),
    ("2*t - 1", "both"),
)


def instants(scene: Scene) -> Iterator[Cell]:
    """Zeros that lie at the end of a step, and between two, of both directions: each is met once, at its time."""
    ways: tuple[tuple[str, dict[str, Any]], ...] = (
        ("rk4", {"dt": 0.1}),
        ("rk4", {"dt": 0.25}),
        ("dopri5", {"rtol": 1e-8, "atol": 1e-10}),
    )
    for method, options in ways:
        worst = 0.0
        for terminal in (False, True):
            for formula, direction in _CROSSINGS:
                event = sf.Event(formula, direction, terminal)
                opposite = sf.Event(formula, "falling" if direction == "rising" else "rising")
                events = {"met": event} | ({} if direction == "both" else {"not": opposite})
                run = sf.simulate(scene.model, scene.q, scene.v, 1.0, method=method, events=events, **options)
                met = [one.t for one in run.events]
                worst = max(worst, abs(met[0] - 0.5) if len(met) == 1 else 1.0)
                worst = max(worst, abs(float(run.t[-1]) - (0.5 if terminal else 1.0)))
        stated = next(iter(options.values()))
        yield Cell(f"instants at the ends of steps, {method} {stated:g}", worst, 1e-9)


def reversed_motion(scene: Scene) -> Iterator[Cell]:
    """The variational rule is symmetric: with speeds turned about, as many steps lead back to where it began."""
    for h in (0.02, 0.01):
        ahead = sf.simulate(scene.model, scene.q, scene.v, 10 * h, method="variational", dt=h)
        back = sf.simulate(scene.model, ahead.q[-1], -ahead.v[-1], 10 * h, method="variational", dt=h)
        end = scene.manifold.same_sign(back.q[-1:], scene.q[None])[0]
        yield Cell(f"reversed time, steps of {h:g} s", max(off(end, scene.q), off(-back.v[-1], scene.v)), REVERSED)


def along(scene: Scene) -> Iterator[Cell]:
    """Integration along the manifold of q by matrix exponentials, and the way back; of several states at once, too."""
    model, rng = scene.model, np.random.default_rng(11)
    sizes = np.logspace(-6, 0, TURNS)  # Series hold below, closed forms above.
    steps = rng.uniform(-0.9, 0.9, (TURNS, model.nv)) * sizes[:, None]
    wanted = np.array([scene.manifold.retract(scene.q, step, twist=True) for step in steps])
    found = np.asarray(model.integrate(scene.q, steps))
    moved = np.abs(scene.manifold.same_sign(found, wanted) - wanted).max(axis=1)
    yield Cell("integrate", float((moved / np.maximum(sizes, 1e-3)).max()), ROUNDING)
    back = np.asarray(model.difference(scene.q, wanted))
    yield Cell("difference", max(off(one, step) for one, step in zip(back, steps, strict=True)), 1e-8)
    yield Cell("difference, of the largest", off(back, steps), ROUNDING)


def sampled_finely(scene: Scene) -> Iterator[Cell]:
    """Lines through many samples of a smooth input are that input: no step ends at each; corners are seen."""
    model, name, n = scene.model, scene.model.names.u[0], 4001
    t = np.linspace(0.0, 0.5, n)
    given: dict[str, Any] = {"method": "dopri5", "rtol": 1e-8, "atol": 1e-9}
    lines = {name: sf.Signal(t, 2 * np.sin(9 * t))}
    for method in ("dopri5", "cvode"):
        if method == "cvode" and util.find_spec("sksundae") is None:
            yield Cell("an input sampled finely, cvode", 0.0, 1e-5, absent="pip install scikit-sundae")
            continue
        options = {**given, "method": method}
        exact = sf.simulate(model, scene.q, scene.v, 0.5, u={name: "2*sin(9*t)"}, **options)
        run = sf.simulate(model, scene.q, scene.v, 0.5, u=lines, **options)
        error = max(off(run.q[-1], exact.q[-1]), off(run.v[-1], exact.v[-1]))
        yield Cell(f"an input sampled finely, {method}", error, 1e-5)
        most, steps = 8.0 * exact.statistics.steps, run.statistics.steps
        yield Cell(f"its steps, {method}", float(steps > most), SAME, f"{steps} steps, at most {most:g}")
    jagged = np.interp(t, [0.0, 0.11, 0.1100625, 0.3, 0.5], [0.0, 0.0, 40.0, 40.0, -40.0])
    runs = [
        sf.simulate(model, scene.q, scene.v, 0.5, u={name: sf.Signal(t, jagged)}, max_step=most_step, **given)
        for most_step in (np.inf, 1.25e-4)
    ]
    yield Cell("an input with corners", max(off(runs[0].q[-1], runs[1].q[-1]), off(runs[0].v[-1], runs[1].v[-1])), 1e-6)


def acted(scene: Scene) -> Iterator[Cell]:
    """Actions at events set speeds: a motion with two of them is three motions in a row."""
    model, q, v = scene.model, scene.q, scene.v
    name, t_end, kicks = model.names.v[0], 0.5, ((0.1, 0.7), (0.33, -0.4))
    events = {f"kick {t}": sf.Event(f"t - {t}", "rising", action={f"d{name}": value}) for t, value in kicks}
    run = sf.simulate(model, q, v, t_end, u=scene.u, method="rk4", dt=STEP, events=events)
    t = 0.0
    for end, value in (*kicks, (t_end, None)):
        piece = sf.simulate(model, q, v, end, u=scene.u, method="rk4", dt=STEP, t0=t)
        q, v, t = piece.q[-1], piece.v[-1].copy(), end
        if value is not None:
            v[0] = value
    yield Cell("actions at events", max(off(run.q[-1], q), off(run.v[-1], v)), 1e-7)


def run_notes(scene: Scene) -> Iterator[Cell]:
    """What a run says of itself: where it was cut, across actions too; a pulse that steps pass over; silence else."""
    model, name = scene.model, scene.model.names.u[0]
    given: dict[str, Any] = {"method": "rk4", "dt": STEP}
    kick = {"kick": sf.Event("t - 0.105", "rising", action={f"d{model.names.v[0]}": 0.3})}
    run = sf.simulate(model, scene.q, scene.v, 0.5, events=kick, max_steps=20, **given)
    cut = float(run.outcome.kind != "interrupted") + abs(run.statistics.steps - 20)
    yield Cell("steps to an end, across an action", float(cut), SAME)
    still = np.zeros(model.nv)
    for what, width, noted in (("between steps", 5e-4, True), ("of many steps", 0.2, False)):
        pulse = f"{1.0 / width}*exp(-((t - 0.2525)/{width})^2)"
        run = sf.simulate(model, scene.q, still, 0.5, u={name: pulse}, **given)
        yield Cell(f"notes on a pulse {what}", float(bool(run.outcome.notes) != noted), SAME)


def balanced(scene: Scene) -> Iterator[Cell]:
    """Energy that a step of fourth order loses: half the step leaves a sixteenth of it, in the same time."""

    def lost(h: float, steps: int) -> float:
        run = sf.simulate(scene.model, scene.q, scene.v, steps * h, method="rk4", dt=h)
        energies = [
            float(scene.model.kinetic_energy(run.q[i], run.v[i]) + scene.model.potential_energy(run.q[i]))
            for i in (0, -1)
        ]
        size = float(scene.model.kinetic_energy(run.q[0], run.v[0]))
        return abs(energies[1] - energies[0]) / size

    coarse, fine = lost(0.02, 4), lost(0.01, 8)
    # Between a fourth and fifth power, with a margin, where rounding does not rule.
    yield Cell("energy of half the step", fine, max(coarse / 10.0, 1e-13), f"{coarse:.1e} at the full step")


def drifting(scene: Scene) -> Iterator[Cell]:
    """Free mechanism without outer forces: momentum stays, but for what steps of eighth order lose."""
    run = sf.simulate(scene.model, scene.q, scene.v, 0.5, method="dop853", rtol=1e-11, atol=1e-12)
    first, last = (_momentum(scene, run.q[i], run.v[i]) for i in (0, -1))
    yield Cell("momentum of a free motion", off(last, first), 1e-9)


def _momentum(scene: Scene, q: Array, v: Array) -> Array:
    return np.asarray(scene.model.centroidal_momentum(q, v))
