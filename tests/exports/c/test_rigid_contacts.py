"""Rigid contacts in packages: the motions of sf.simulate, in calls of any length (docs/theory/constraints.md, 15)."""

from __future__ import annotations

from collections.abc import Iterable
from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.stepping.status import Status
from tests.exports import cases
from tests.exports.cases import run
from tests.models import bounds
from tests.simulation.rigid_scenes import (
    WITHOUT_ANSWER,
    G,
    ball_system,
    box_system,
    disc_system,
    in_shell,
    rod_system,
    three_feet,
)

MAIN, BY_HAND = (Path(__file__).with_name(name).read_text() for name in ("events.c", "contacts.c"))
LEANS = {"free.pz": 0.2, "free.qx": sin(0.35), "free.qw": cos(0.35)}
SCENES: dict[str, tuple[sf.System, dict[str, float]]] = {
    "falls": (ball_system(), {"free.pz": 0.2, "free.vx": 2.0}),
    "strikes at once": (ball_system(), {"free.pz": 0.1, "free.vz": -1.0, "free.wy": 20.0}),
    "rod": (rod_system(0.4, 0.3), {"z": cos(0.5) + 0.05, "angle": 0.5, "dx": 1.0}),
    "box": (box_system(0.3), {"free.pz": 0.11, "free.vx": 1.0, "free.vy": 0.5, "free.wz": 2.0, "free.wx": 0.2}),
    "shell": (in_shell(0.3, (0, 1, 0), 2.5), {"ball.px": 0.4, "ball.vy": 3.0, "ball.vz": 2.0, "ball.wx": 3.0}),
    "rims": (disc_system(0.3, 0.3, 0.03), LEANS | {"free.vx": -0.6, "free.wx": -2.0, "free.wy": -3.0, "free.wz": 6.0}),
}


def packaged(folder: Path, main: str, system: sf.System, start: dict[str, float], **options: Any) -> Path:
    """A program of a system's package and a main."""
    return cases.packaged(system, folder / "c", main, name="plan", start=start, dt=1e-3, **options)


def first(model: sf.Model, start: dict[str, float]) -> tuple[Any, dict[str, float]]:
    """Coordinates and speeds as a start states them."""
    q = model.neutral()
    for name in start.keys() & set(model.names.q):
        q[model.names.q.index(name)] = start[name]
    return q, {name: x for name, x in start.items() if name not in model.names.q}


def distinct(instants: Iterable[float]) -> list[float]:
    """Instants of events, those that are the same once."""
    sorted_ones = sorted(instants)
    return [t for t, before in zip(sorted_ones, [-1.0, *sorted_ones], strict=False) if t - before > 1e-9]


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("scene", SCENES)
def test_packages_move_as_runs_do(tmp_path: Path, scene: str, method: str) -> None:
    """Each event at its instant, and the state at the end; again after a reset."""
    system, start = SCENES[scene]
    options: dict[str, Any] = {"method": method} | bounds(method, 1e-9, 1e-12)
    program = packaged(tmp_path, MAIN, system, start, **options)
    model, t_end = sf.compile(system), 1.0 if "box" not in scene else 0.2
    q, v = first(model, start)
    known = sf.simulate(model, q, v, t_end=t_end, dt=1e-3, **options)
    for span in (t_end / 20, t_end):
        # Steps that adapt begin anew at each call, and differ within their bounds; those of rims do by rounding (41b).
        # Strikes up to 1e-4 of the first pass 6e-11 s on from what is rounding between both.
        bound = 1e-6 if method == "dopri5" and (span < t_end or scene == "rims") else 2e-10
        *met, status, state = run(program, repr(span), repr(t_end), cwd=tmp_path).splitlines()
        assert status == f"status {Status.FINISHED}"
        assert distinct(float(line.split()[1]) for line in met) == pytest.approx(
            distinct(found.t for found in known.events), abs=bound
        )
        numbers = np.array(state.split()[1:], dtype=float)
        # A rim's strikes act on how it turns, and multiply rounding more.
        margin = 100 if scene == "rims" else 10
        assert numbers == pytest.approx(np.concatenate([known.q[-1], known.v[-1]]), abs=margin * bound)
    assert len(known.events) > 2


def test_tolerances_of_packages_are_those_of_runs_by_default(tmp_path: Path) -> None:
    """From the same first step on a package makes the steps of a run, and bounces at its instants."""
    system, start = SCENES["falls"]
    program = packaged(tmp_path, MAIN, system, start, method="dopri5")
    known = sf.simulate(sf.compile(system), *first(sf.compile(system), start), t_end=1.0, method="dopri5", dt=1e-3)
    *met, _, state = run(program, "1.0", "1.0", cwd=tmp_path).splitlines()
    assert [float(line.split()[1]) for line in met] == pytest.approx([found.t for found in known.events], abs=1e-13)
    assert np.array(state.split()[1:], dtype=float) == pytest.approx([*known.q[-1], *known.v[-1]], abs=1e-12)


def test_packages_step_implicitly_over_contacts(tmp_path: Path) -> None:
    """By rodas4, with the derivatives of friction: strikes, slides and turns of a rod and of two rims."""
    for scene in ("rod", "rims"):
        system, start = SCENES[scene]
        program = packaged(tmp_path / scene, MAIN, system, start, method="rodas4", rtol=1e-7, atol=1e-10)
        model = sf.compile(system)
        q, v = first(model, start)
        known = sf.simulate(model, q, v, t_end=1.0, method="dopri5", rtol=1e-10, atol=1e-12)
        *met, status, _ = run(program, "0.05", "1.0", cwd=tmp_path).splitlines()
        assert status == f"status {Status.FINISHED}"
        instants = distinct(float(line.split()[1]) for line in met)
        assert instants[:3] == pytest.approx(distinct(found.t for found in known.events)[:3], abs=1e-6)


@pytest.mark.parametrize(("pull", "chosen"), [(5.0, {}), (8.0, {"functions": ["mass_matrix"]})])
def test_changes_by_the_caller_between_calls_take_effect(tmp_path: Path, pull: float, chosen: dict[str, Any]) -> None:
    """A force beyond friction lets a box slide from that call on; a box that is lifted by hand falls, or flies up."""
    mu, mass, lift, up = 0.3, 2.0, 0.02, 0.8
    program = packaged(tmp_path, BY_HAND, box_system(mu), {"free.pz": 0.1}, **chosen)
    *_, drawn, _, lifted = run(program, repr(pull), repr(lift), cwd=tmp_path).splitlines()
    first, last = (np.array(line.split()[1:], dtype=float) for line in (drawn, lifted))
    a = max(0.0, pull / mass - mu * G)
    assert first[[0, 7]] == pytest.approx([a * 0.1**2 / 2, a * 0.1], abs=1e-12)
    # In the air for sqrt(2 lift/g) = 0.064 s, then on the ground: the plastic strike takes mu times the normal impulse.
    fall = (2 * lift / G) ** 0.5
    left = max(0.0, a * 0.1 - mu * G * fall)
    slides = max(0.0, min(0.1 - fall, left / (mu * G)))
    assert last[2] == pytest.approx(0.1, abs=1e-12)
    way = first[0] + a * 0.1 * fall + left * slides - mu * G * slides**2 / 2
    assert last[0] == pytest.approx(way, abs=1e-12)
    # Its speeds alone are set: whatever it did, it is in the air for 2 up/g = 0.16 s.
    thrown = np.array(run(program, repr(pull), "0", repr(up), cwd=tmp_path).splitlines()[-1].split()[1:], dtype=float)
    wanted = [first[0] + a * 0.1**2, 0.1 + up * 0.1 - G * 0.1**2 / 2]
    assert thrown[[0, 2]] == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize(("share", "when"), [(1.0, "0"), (0.0, "-inf")])
def test_packages_tell_that_balls_struck_in_sequence(tmp_path: Path, share: float, when: str) -> None:
    """No motion was found in which they strike at once; without spin there is one."""
    speeds = zip(("vx", "vy", "vz", "wx", "wy", "wz"), WITHOUT_ANSWER, (1, 1, 1, share, share, share), strict=True)
    start = {"free.pz": 0.1} | {f"free.{name}": speed * of for name, speed, of in speeds}
    program = packaged(tmp_path, BY_HAND, three_feet(), start)
    status = run(program, "0", "0", cwd=tmp_path).splitlines()[0]
    assert status == f"status {Status.FINISHED}, in sequence at {when} s"


def test_packages_refuse_methods_without_modes_and_targets_without_events(tmp_path: Path) -> None:
    """Methods that choose no modes, and targets that look for no events."""
    with pytest.raises(sf.SymofrosError, match="is rigid"):
        sf.export(ball_system(), "c", tmp_path / "c", method="generalized_alpha")
    with pytest.raises(sf.SymofrosError, match="is rigid"):
        sf.export(ball_system(), "sfunction", tmp_path / "s")
