"""Functions made ahead of their first call, several at the same time: the same code, each unit once."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.generator.units import UnitCompiler


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[tuple[Sequence[Any], str]]:
    """Keys of each unit that is made with an empty cache, and the thread that did."""
    units: list[tuple[Sequence[Any], str]] = []
    original = UnitCompiler.functions

    def noted(self: UnitCompiler, keys: Sequence[Any], *meanwhile: Any) -> Any:
        units.append((keys, threading.current_thread().name))
        return original(self, keys, *meanwhile)

    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    monkeypatch.setattr(UnitCompiler, "functions", noted)
    return units


def test_each_unit_is_made_once_by_a_thread_of_its_own(made: list[tuple[Sequence[Any], str]]) -> None:
    m = sf.compile(MODELS["four_bar"])
    assert made == []  # Whoever calls nothing waits for no compiler.
    m.prepare("forward_dynamics", "project", "constraint", "constraint_jacobian", "kinetic_energy", "dynamics")
    assert len({name for keys, _ in made for name in keys}) == sum(len(keys) for keys, _ in made)
    assert {keys[0][0] for keys, _ in made} == {"forward_dynamics", "constraint", "kinetic_energy", "dynamics"}
    assert len({thread for _, thread in made}) == 4
    m.prepare("forward_dynamics", "kinetic_energy")
    assert len(made) == 4


@pytest.mark.parametrize("backend", ["c", "interpreter"])
def test_results_equal_those_of_functions_compiled_one_by_one(backend: Any, rng: np.random.Generator) -> None:
    """To the bit: the graphs of units are formed in turn."""
    options = sf.Options(backend=backend)
    together, apart = (sf.compile(MODELS["planar_robot"], options) for _ in range(2))
    together.prepare("forward_dynamics", "kinetic_energy", "inverse_dynamics", "bias")
    (q, v), u = apart.random_state(rng), rng.normal(size=apart.nu)
    np.testing.assert_array_equal(together.forward_dynamics(q, v, u), apart.forward_dynamics(q, v, u))
    np.testing.assert_array_equal(together.inverse_dynamics(q, v, v), apart.inverse_dynamics(q, v, v))
    assert together.kinetic_energy(q, v) == apart.kinetic_energy(q, v)


def test_a_model_of_chosen_functions_stays_as_it_is(made: list[tuple[Sequence[Any], str]]) -> None:
    m = sf.compile(MODELS["pendulum"], sf.Options(functions=("forward_dynamics",)))
    made.clear()
    m.prepare("forward_dynamics", "kinetic_energy")
    assert not made
