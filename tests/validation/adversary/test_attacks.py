"""Each attack sees the fault that it looks for, shrinks it, and finds nothing where nothing is planted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import symofros as sf
from symofros.simulation.results.outcome import Outcome
from validation.adversary.report import ATTACKS
from validation.adversary.search import Budget, Find, Tally, hunt

Plant = Callable[[pytest.MonkeyPatch], None]
FINE = "dop853"


def hunted(name: str, folder: Path, examples: int, seed: int = 0) -> tuple[Find | None, Tally]:
    tally = Tally()
    return hunt(ATTACKS[name], folder, seed, Budget(inf, examples), tally, set()), tally


def wrong(name: str, by: float) -> Plant:
    """A method of models whose first result is wrong by a factor."""

    def plant(monkeypatch: pytest.MonkeyPatch) -> None:
        sound = getattr(sf.Model, name)

        def faulty(*given: Any, **named: Any) -> Any:
            result = sound(*given, **named)
            return (result[0] * by, *result[1:]) if isinstance(result, tuple) else result * by

        monkeypatch.setattr(sf.Model, name, faulty)

    return plant


def runs(change: Callable[[sf.Trajectory], sf.Trajectory], **options: Any) -> Plant:
    """Runs, but for the finer ones, that are not what they should be."""

    def plant(monkeypatch: pytest.MonkeyPatch) -> None:
        sound = sf.simulate

        def faulty(*given: Any, **named: Any) -> sf.Trajectory:
            if named.get("method") == FINE or "rtol" in named and named["rtol"] == 1e-5:
                return sound(*given, **named)
            return change(sound(*given, **{**named, **options}))

        monkeypatch.setattr(sf, "simulate", faulty)

    return plant


def silenced(run: sf.Trajectory) -> sf.Trajectory:
    """A run that says that all is well, whatever it met."""
    calm = Outcome("finished", run.outcome.t, "steps are done")
    return replace(run, outcome=calm, bendings=tuple(replace(bending, error=0.0) for bending in run.bendings))


def equilibria_without_estimates(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = sf.equilibrium

    def faulty(*given: Any, **named: Any) -> sf.Equilibrium:  # type: ignore[name-defined]
        rest = sound(*given, **named, beam_limit=inf)
        return replace(rest, notes=(), bendings=tuple(replace(bending, error=0.0) for bending in rest.bendings))

    monkeypatch.setattr(sf, "equilibrium", faulty)


def silent_diagrams(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = sf.Simulation.run

    def faulty(*given: Any, **named: Any) -> sf.DiagramRun:
        run = sound(*given, **named)
        return replace(run, outcome=replace(run.outcome, notes=()))

    monkeypatch.setattr(sf.Simulation, "run", faulty)


def always_converged(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = sf.inverse_kinematics
    monkeypatch.setattr(sf, "inverse_kinematics", lambda *a, **k: replace(sound(*a, **k), converged=True))


def half_turns_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sf, "assemble", lambda model, q, *_, **__: SimpleNamespace(q=q))


FAULTS: dict[str, Plant] = {
    "rigid_trees": wrong("forward_dynamics", 1.0 + 1e-5),
    "closed_dynamics": wrong("constrained_dynamics", 1.0 + 1e-6),
    "loop_runs": runs(lambda run: replace(run, q=1.001 * run.q)),
    "rolling_runs": runs(lambda run: replace(run, v=1.3 * run.v)),
    "step_sizes": runs(silenced),
    "diagram_runs": silent_diagrams,
    "beam_statics": equilibria_without_estimates,
    "beam_runs": runs(silenced, beam_limit=inf),
    "inverse_kinematics": always_converged,
    "event_runs": runs(lambda run: replace(run, events=run.events[1:])),
    "pushed_runs": runs(lambda run: replace(run, v=1.5 * run.v)),
    "overconstrained_runs": runs(lambda run: replace(silenced(run), q=1.5 * run.q)),
    "held_apart": half_turns_pass,
    "engaging_runs": silent_diagrams,
}


def test_each_attack_has_a_planted_fault() -> None:
    assert FAULTS.keys() == ATTACKS.keys()


# Runs of loops and of steps that are too long show in every run what those of beams and of wheels would.
LONG = ("beam_runs", "rolling_runs")


@pytest.mark.parametrize("name", [pytest.param(x, marks=pytest.mark.slow) if x in LONG else x for x in FAULTS])
def test_a_planted_fault_is_found_and_its_scene_is_plain(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    attack = ATTACKS[name]
    FAULTS[name](monkeypatch)
    find, tally = hunted(name, tmp_path, 60)
    assert find is not None and tally.tried <= 60
    assert not attack.verdict(find.scene).sound
    monkeypatch.undo()
    assert attack.verdict(find.scene).sound


@pytest.mark.parametrize(("scenes", "agreed"), [(4, 1), pytest.param(200, 11, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ATTACKS)
def test_scenes_contradict_nothing(name: str, scenes: int, agreed: int, tmp_path: Path) -> None:
    find, tally = hunted(name, tmp_path, scenes, seed=int(scenes > 4))
    assert find is None, find
    # What can't be is refused by each.
    assert tally.tried >= 4 and (tally.refused if name == "held_apart" else tally.agreed) >= agreed, tally


@pytest.mark.parametrize("name", ATTACKS)
def test_scenes_can_be_written_as_descriptions(name: str, tmp_path: Path) -> None:
    find, _ = hunted_scene(name, tmp_path)
    stated = ATTACKS[name].system(find)
    sf.save(stated, tmp_path / "scene.yaml")
    assert sf.load(tmp_path / "scene.yaml") == stated


def hunted_scene(name: str, folder: Path) -> tuple[dict[str, Any], Tally]:
    """The plainest scene of an attack."""
    tally = Tally()
    anything = replace(ATTACKS[name], judge=lambda scene: 1 / 0)
    find = hunt(anything, folder, 0, Budget(inf, 40), tally, set())
    assert find is not None and find.quantity.startswith("ZeroDivisionError")
    return find.scene, tally
