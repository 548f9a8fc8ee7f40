"""What journeys cost: how often equations are formed, C is compiled, a description is checked."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import reference_models
import symofros as sf
from reference_models import MODELS
from symofros.generator import programs
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.topology import find_problems, graph
from symofros.runtime.build import build
from symofros.runtime.calls import binding, extension
from symofros.studio.editor.jobs.operations import compile_model, simulate


@pytest.fixture
def work(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Counter[str]:
    """Work done so far, with an empty cache."""
    done: Counter[str] = Counter()
    # The extension for plain calls is compiled behind the first one of a process, whichever test that is.
    extension.load()
    for thread in threading.enumerate():
        if thread.name == "symofros_call":
            thread.join()

    def count(owner: Any, name: str, kind: str) -> None:
        original: Callable[..., Any] = getattr(owner, name)

        def counting(*arguments: Any, **named: Any) -> Any:
            done[kind] += 1
            return original(*arguments, **named)

        monkeypatch.setattr(owner, name, counting)

    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    binding.native_library.cache_clear()  # Another test of this process may have loaded it.
    count(Equations, "__init__", "derivations")
    count(programs, "form_program", "programs")
    count(build, "call_compiler", "compilations")
    count(graph, "_collect_problems", "checks")
    return done


def test_compiling_an_arm_derives_it_once(work: Counter[str]) -> None:
    sf.compile(MODELS["puma560"]).prepare("dynamics")
    assert work["derivations"] == work["programs"] == work["compilations"] == 1


def test_a_model_that_is_known_is_not_derived(work: Counter[str]) -> None:
    model = sf.compile(MODELS["puma560"])
    q = model.neutral()
    model.prepare("dynamics")
    work.clear()
    sf.compile(MODELS["puma560"]).dynamics(q, q, q)
    assert work["derivations"] == work["programs"] == work["compilations"] == 0


@pytest.mark.parametrize("kind", ["tree", "loop"])
def test_a_simulation_after_a_click_on_compile_derives_and_compiles_nothing(work: Counter[str], kind: str) -> None:
    """One derivation for what is counted and for what is compiled; units of functions as a run calls them."""
    text = ARM if kind == "tree" else FOUR_BAR.read_text()
    request: dict[str, Any] = {"file": "arm.yaml", "text": text}
    result = compile_model(request, lambda *_: None)
    assert result["nq"] == (1 if kind == "tree" else 3) and "mass_matrix" in result["operations"]
    assert work["derivations"] == work["checks"] == 1
    work.clear()
    found = simulate(request | {"options": {"t_end": 0.01}}, lambda *_: None)
    assert found["outcome"]["ok"]
    assert work["derivations"] == work["programs"] == work["compilations"] == 0


FOUR_BAR = Path(reference_models.__file__).parent / "closed" / "four_bar.yaml"
ARM = """\
symofros: 1
bodies:
  a:
    joint: {name: x, kind: revolute}
    inertia: {mass: 2, moments: [1, 1, 1]}
"""


def test_simulating_a_loop_from_a_file_derives_it_once(work: Counter[str], tmp_path: Path) -> None:
    """Compiled: M, h and Q; the constraints; forward dynamics with the projection; the energies; and the stepper."""
    file = tmp_path / "slider_crank.yaml"
    sf.save(MODELS["slider_crank"], file)
    work.clear()
    model = sf.compile(sf.load(file))
    start = sf.assemble(model, v=[1.0, 0.0, 0.0], held=model.names.v[:1])
    run = sf.simulate(model, start.q, start.v, 0.01)
    assert np.ptp(run.energy) < 1e-6 * run.energy[0]
    assert work["derivations"] == work["checks"] == 1
    assert work["programs"] == 4
    assert work["compilations"] == 5


def test_results_do_not_depend_on_earlier_requests(work: Counter[str], rng: np.random.Generator) -> None:
    """To the bit: each unit is formed on kinematics alone, whatever else the model has formed."""
    options = sf.Options(backend="interpreter")
    fresh, used = (sf.compile(MODELS["slider_crank"], options) for _ in range(2))
    (q, v), u = fresh.random_state(rng), rng.normal(size=fresh.nu)
    used.inverse_dynamics(q, v, v), used.constraint_bias(q, v), used.kinetic_energy(q, v)
    np.testing.assert_array_equal(used.forward_dynamics(q, v, u), fresh.forward_dynamics(q, v, u))
    np.testing.assert_array_equal(used.mass_matrix(q), fresh.mass_matrix(q))


def test_a_changed_system_is_checked_again() -> None:
    sound = MODELS["puma560"]
    assert find_problems(sound) == []
    assert find_problems(replace(sound, inputs=(sf.Input("q1"),)))
