"""Derivatives of dynamics in C: against differences, against their twin in NumPy, by every solver."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from reference_models.rigid.chain import chain
from symofros.compiler import Compilation
from tests.models import sampled, state_of, system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import analyses

# State: guesses that assembly closes, or none for trees.
CLOSED = {
    "four_bar": [1.2, -1.2, 1.2],
    "slider_crank": [0.5, -0.7, 0.4],
    "rolling_disc": [0, 0, 0.5, 0.5, 0.5, 0.5, 0.5],
}
OPEN = ("pendulum", "cart_pole", "rx90", "space_arm", "flexible_pendulum", "parametrised0", "parametrised2")
CASES = (*OPEN, *CLOSED)
LARGE = ("rx90", "space_arm", "parametrised0", "parametrised2")
# With parameters that are no numbers of the text.
PARAMETRISED = ("four_bar", "slider_crank", "cart_pole", "parametrised0", "parametrised2")


@cache
def model(name: str, backend: str = "c") -> sf.Model:
    stated = system(name) if name.startswith("parametrised") else MODELS[name]
    return sf.compile(stated, sf.Options(backend=backend))


def state(name: str, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return state_of(model(name), CLOSED.get(name), seed)


@pytest.mark.parametrize("name", sampled(CASES, [name for name in CASES if name not in LARGE]))
def test_c_derivatives_match_the_interpreter(name: str) -> None:
    q, v, u = state(name)
    c = model(name).forward_dynamics_derivatives(q, v, u)
    twin = model(name, "interpreter").forward_dynamics_derivatives(q, v, u)
    for ours, theirs in zip(c, twin, strict=True):
        assert np.abs(ours - theirs).max(initial=0) < 1e-11 * max(1.0, np.abs(theirs).max(initial=0))


@pytest.mark.parametrize(
    "name",
    sampled(PARAMETRISED, [name for name in PARAMETRISED if name not in LARGE]),
)
def test_parameter_derivatives_match_differences(name: str) -> None:
    """And those by the state."""
    assert_agrees(analyses.differentiated, system(name))


def test_derivatives_accept_batches_and_parameters() -> None:
    m = model("slider_crank")
    many = [state("slider_crank", seed) for seed in range(3)]
    q, v, u = (np.array(x) for x in zip(*many, strict=True))
    par = np.array(list(m.parameters.values())) * np.array([[1.0], [1.01], [1.02]])
    together = m.forward_dynamics_derivatives(q, v, u, par=par)
    for i, one in enumerate(many):
        for all_of, alone in zip(together, m.forward_dynamics_derivatives(*one, par=par[i]), strict=True):
            assert np.array_equal(all_of[i], alone)


def test_a_massless_speed_is_refused() -> None:
    bodies = (
        sf.RigidBody("a", sf.Joint("q1", "revolute"), sf.Inertia(1.0, (0.5, 0, 0), (0.1, 0.1, 0.1))),
        sf.RigidBody("b", sf.Joint("q2", "revolute", "a"), None, waive=("massless_tip",)),
    )
    m = sf.compile(sf.System("s", bodies), sf.Options(backend="interpreter"))
    with pytest.raises(sf.DescriptionError, match="speed 'q2' moves no mass"):
        m.forward_dynamics_derivatives([0.1, 0.2], [0, 0], [])


@pytest.mark.parametrize("name", sampled(("puma560", "random_tree4", "random_tree1", "mss"), ("random_tree4",)))
def test_the_blocked_solver_matches_generated_elimination(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Large trees are solved by a routine, in blocks: here with speeds that fill none, and zeros between branches."""
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))  # What is kept there was made by a generator as it is.
    options = sf.Options(("forward_dynamics_derivatives",))
    generated = sf.compile(MODELS[name], options)
    monkeypatch.setattr("symofros.base.routes.MOST_STEPS", -1)
    by_routine = sf.compile(MODELS[name], options)
    assert Compilation(MODELS[name], options).program.functions[0].solver is not None
    q, v = generated.random_state(np.random.default_rng(11))
    u = np.linspace(-1.0, 1.0, generated.nu)
    for ours, theirs in zip(
        by_routine.forward_dynamics_derivatives(q, v, u), generated.forward_dynamics_derivatives(q, v, u), strict=True
    ):
        # Elimination in two orders: some units in the last place of the largest entry, times the condition of M.
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-11 * max(1.0, np.abs(theirs).max()))


@pytest.mark.parametrize("backend", ["c", "interpreter", "tape"])
@pytest.mark.parametrize("name", sampled(("heavy_top", "car", "random_tree4", "spdm", "mss"), ("heavy_top", "car")))
def test_sweeps_match_generated_elimination(
    name: str, backend: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Long trees go by sweeps over their speeds: here with branches, free and ball joints, and springs."""
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))  # What is kept there was made by a generator as it is.
    generated = sf.compile(MODELS[name], sf.Options(backend=backend))  # type: ignore[arg-type]
    q, v = generated.random_state(np.random.default_rng(12))
    u = np.linspace(-1.0, 1.0, generated.nu)
    expected = generated.forward_dynamics_derivatives(q, v, u)
    monkeypatch.setattr("symofros.base.routes.SWEPT", -1)
    swept = sf.compile(MODELS[name], sf.Options(backend=backend))  # type: ignore[arg-type]
    derivatives = swept.forward_dynamics_derivatives(q, v, u)
    assert swept.routes["forward_dynamics_derivatives"][0].method == "sweeps"
    for ours, theirs in zip(derivatives, expected, strict=True):
        # Another elimination: some units in the last place of the largest entry, times the condition of M.
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-11 * max(1.0, np.abs(theirs).max(initial=0.0)))


def test_derivatives_of_a_long_chain_are_those_by_differences() -> None:
    """By sweeps, without an option: by q and v against central differences, by u against M."""
    m = sf.compile(chain(32, symbolic=False), sf.Options(backend="interpreter"))
    assert m.routes["forward_dynamics_derivatives"][0].method == "sweeps"
    q, v = m.random_state(np.random.default_rng(13))
    u, h = np.zeros(m.nu), 5e-7
    by_q, by_v, by_u = m.forward_dynamics_derivatives(q, v, u)
    for k in (0, 15, 31):
        e = h * np.eye(m.nv)[k]
        change = m.forward_dynamics(q + e, v, u) - m.forward_dynamics(q - e, v, u)
        np.testing.assert_allclose(by_q[:, k], change / (2 * h), rtol=0, atol=1e-6 * np.abs(by_q).max())
        change = m.forward_dynamics(q, v + e, u) - m.forward_dynamics(q, v - e, u)
        np.testing.assert_allclose(by_v[:, k], change / (2 * h), rtol=0, atol=1e-6 * np.abs(by_v).max())
    np.testing.assert_allclose(by_u @ m.mass_matrix(q), np.eye(m.nv), rtol=0, atol=1e-6)
