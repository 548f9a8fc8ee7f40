"""Plain calls for one state: the bits of a batch, in new arrays, whatever kind of numbers is given."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.runtime.calls import extension
from tests.models import model

FUNCTIONS = {
    "mass_matrix": ("q",),
    "bias": ("q", "v"),
    "generalized_force": ("q", "v", "u"),
    "dynamics": ("q", "v", "u"),
    "forward_dynamics": ("q", "v", "u"),
    "inverse_dynamics": ("q", "v", "a"),
    "kinetic_energy": ("q", "v"),
    "constraint": ("q",),
    "constraint_jacobian": ("q",),
}


@pytest.fixture(params=["extension", "c", "interpreter"])
def m(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> sf.Model:
    """A model with calls by the extension, of compiled functions through NumPy, and of interpreted ones."""
    if request.param == "extension" and extension.load() is None:
        pytest.skip("needs the headers of Python")
    call_type = extension.load() if request.param == "extension" else None
    monkeypatch.setattr("symofros.runtime.calls.plain.call_type", lambda _: call_type)
    # One that has prepared no call yet, and shares the compiled functions.
    return model("parametrised0", "interpreter" if request.param == "interpreter" else "c").with_parameters()


def state(m: sf.Model, rng: np.random.Generator) -> dict[str, np.ndarray]:
    q, v = m.random_state(rng)
    return {"q": q, "v": v, "u": rng.normal(size=m.nu), "a": rng.normal(size=m.nv)}


def outputs(results: Any) -> list[np.ndarray]:
    return list(results) if isinstance(results, tuple) else [results]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_plain_calls_equal_batch_bits(m: sf.Model, name: str, rng: np.random.Generator) -> None:
    for _ in range(3):
        given = state(m, rng)
        single = outputs(getattr(m, name)(*(given[group] for group in FUNCTIONS[name])))
        batch = outputs(getattr(m, name)(*(given[group][None] for group in FUNCTIONS[name])))
        for one, many in zip(single, batch, strict=True):
            assert one.shape == many.shape[1:]
            assert np.array_equal(one, many[0])


def test_each_call_gives_arrays_of_its_own(m: sf.Model, rng: np.random.Generator) -> None:
    q0, q1 = m.random_state(rng)[0], m.random_state(rng)[0]
    M = m.mass_matrix(q0)
    before = M.copy()
    m.mass_matrix(q1)[:] = 0.0
    assert np.array_equal(M, before)
    assert np.array_equal(m.mass_matrix(q0), before)


def test_parameters_and_inputs_are_not_remembered(m: sf.Model, rng: np.random.Generator) -> None:
    given = state(m, rng)
    q, v, u = given["q"], given["v"], given["u"]
    default = np.array(m.record.u_default)
    before = m.generalized_force(q, v, default), m.mass_matrix(q)
    m.generalized_force(q, v, u + 1.0)
    m.mass_matrix(q, u=u + 1.0, par=m.parameter_values * 1.1)
    assert np.array_equal(m.generalized_force(q, v, None), before[0])
    assert np.array_equal(m.mass_matrix(q), before[1])
    heavier = m.with_parameters(**{name: 1.1 * value for name, value in m.parameters.items()})
    assert np.array_equal(heavier.mass_matrix(q), m.mass_matrix(q, par=m.parameter_values * 1.1))
    assert np.array_equal(m.mass_matrix(q), before[1])


# A call of the interpreter takes so long that threads change places within each.
@pytest.mark.parametrize(("backend", "calls"), [("c", 50), ("interpreter", 3)])
def test_threads_do_not_share_memory(backend: str, calls: int, rng: np.random.Generator) -> None:
    m = model("parametrised0", backend)
    states = [m.random_state(rng)[0] for _ in range(16)]
    expected = [m.mass_matrix(q) for q in states]

    def many(i: int) -> bool:
        return all(np.array_equal(m.mass_matrix(states[i]), expected[i]) for _ in range(calls))

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(many, range(16)))


def test_numbers_of_any_kind_take_the_short_way_with_time_and_places(
    m: sf.Model, monkeypatch: pytest.MonkeyPatch, rng: np.random.Generator
) -> None:
    """Lists, names and other numbers are converted, and computed as one state: no batch is made of them."""
    given = state(m, rng)
    expected = m.dynamics(given["q"], given["v"], given["u"], t=0.25)
    monkeypatch.setattr("symofros.runtime.calls.library.CompiledKernel.run", None)
    named = dict(zip(m.names.q, given["q"], strict=True))
    M = np.zeros((m.nv, m.nv))
    for q, t in ((given["q"].tolist(), 0.25), (named, np.float64(0.25)), (given["q"].astype(object), np.array(0.25))):
        results = m.evaluate("dynamics", q=q, v=given["v"].tolist(), u=given["u"], t=t, out={"M": M})
        assert results[0] is M
        assert all(np.array_equal(x, y) for x, y in zip(results, expected, strict=True))


def test_a_models_own_parameters_make_a_plain_call(
    m: sf.Model, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As runs and their examination pass them: they were copied, checked and prepared anew at each call."""
    given = state(m, rng)
    by_default = outputs(m.dynamics(given["q"], given["v"], given["u"]))
    monkeypatch.setattr(sf.Model, "_call_batch", None)
    for one, other in zip(
        by_default,
        outputs(m.dynamics(given["q"], given["v"], given["u"], par=m.parameter_values)),
        strict=True,
    ):
        assert np.array_equal(one, other)
    assert np.array_equal(m.mass_matrix(given["q"]), m.mass_matrix(given["q"], par=m.parameter_values))
