"""The model that reductions are judged by: advice is ok by as much as that has converged."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.studio.advice.scene_runner import SceneRunner
from symofros.studio.advice.search import REFINE, _Search

ROPE = sf.Beam("rope", sf.Joint("q", "revolute", axis=(0, 1, 0)), 1.2, 0.1, EI_y=0.01, bend_z=1, family="legendre")


class Runner:
    """In place of simulations: the changes that one function more brings each time, the last for ever."""

    def __init__(self, changes: Sequence[float]) -> None:
        self.changes = list(changes)

    def exact(self, system: sf.System) -> tuple[Any, None]:
        return SimpleNamespace(system=system, values={"tip": np.zeros(1)}), None

    def error(self, trial: Any, reference: Any) -> float:
        return self.changes.pop(0) if len(self.changes) > 1 else self.changes[0]


def settled(changes: Sequence[float], beam: sf.Beam = ROPE) -> _Search:
    search = object.__new__(_Search)
    search.full = search.current = sf.System("swing", (beam,))
    search.runner, search.notes = Runner(changes), []  # type: ignore[assignment]
    search.scene = SimpleNamespace(outputs=[SimpleNamespace(name="tip", bound=lambda _: 1.0)])  # type: ignore[assignment]
    search._within_theory = lambda: search.runner.exact(search.full)[0]  # type: ignore[method-assign]
    search._settle()
    return search


def advice(errors: float, unsettled: float) -> sf.Advice:
    values = dict.fromkeys(sf.Advice.__dataclass_fields__, None) | {"errors": {"tip": errors}, "unsettled": unsettled}
    return sf.Advice(**values)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "unsettled", "converged"),
    [
        ([0.1], 0.0, True),
        ([2.0, 0.2], 0.2 * 0.1 / 0.9, True),
        ([0.65, 1.7, 0.3], 0.3 * (0.3 / 1.7) / (1 - 0.3 / 1.7), True),
        ([0.65, 1.7, 2.7], 2.7, False),
        ([9.0, 3.0, 1.0], 1.0, False),
    ],
)
def test_changes_by_further_functions_count_against_the_advice(
    changes: list[float], unsettled: float, converged: bool
) -> None:
    search = settled(changes)
    assert search.unsettled == pytest.approx(unsettled)
    assert any("not converged" in note for note in search.notes) != converged
    said = [" of the tolerance against one of more functions: refined" in note for note in search.notes]
    assert sum(said) == sum(change > REFINE for change in changes)
    assert advice(0.02, search.unsettled).ok == (0.02 + unsettled <= 1.0)
    assert not advice(1.01, 0.0).ok and advice(1.0, 0.0).ok


def test_user_shape_functions_are_noted_as_not_judged_for_convergence() -> None:
    own = sf.Beam("rope", ROPE.joint, 1.2, 0.1, EI_y=0.01, bend_z=1, family="user", shapes={"bend_z": ["xi^2"]})
    (note,) = settled([5.0], own).notes
    assert "'rope'" in note and "functions of yours" in note
    assert not settled([0.1]).notes


@pytest.mark.parametrize("stiffness", [0.05, 20.0])
def test_a_beam_beyond_its_theory_is_a_rod_in_the_full_model(stiffness: float) -> None:
    """Let go of, its own weight bends it by a radian, where a run of second order ends, or by hundredths."""
    pin = sf.Joint("pin", "revolute", axis=(0, 0, 1))
    beam = sf.Beam("rope", pin, 1.0, 1.0, EI_z=stiffness, bend_y=2, family="legendre")
    scene = sf.Scene(0.2, (sf.Output("end", "position", "tip", absolute=0.5),), samples=10)
    search = object.__new__(_Search)
    search.stated = search.full = search.current = sf.System("soft", (beam,), gravity=(0, -50.0, 0))
    search.scene, search.runner, search.notes = scene, SceneRunner(scene), []
    search._within_theory()
    rod = search.full.body("rope")
    assert isinstance(rod, sf.Beam) and (rod.theory == "strain") == (stiffness < 1.0)
    said = ["the full model has geometrically exact rods in place of its beams" in note for note in search.notes]
    assert said == [True] * (stiffness < 1.0), search.notes
