"""Riccati equations against SciPy's; regulators hold what falls, on open trees and in closed loops."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy import linalg

import symofros as sf
from reference_models import MODELS
from symofros.blocks import LQR, Constant, ForwardDynamics
from symofros.blocks.controllers.riccati import continuous_gain, held_gain, held_inputs, sampled_gain
from symofros.diagrams.program.compiled import resolve
from symofros.diagrams.wiring import surroundings
from tests.blocks.support import refused


@pytest.mark.parametrize(("size", "scale"), [(1, 1.0), (5, 1.0), (5, 300.0), (12, 300.0)])
def test_gains_match_scipy(size: int, scale: float, rng: np.random.Generator) -> None:
    A, B = scale * rng.normal(size=(size, size)), scale * rng.normal(size=(size, 2))
    Q = np.diag(rng.uniform(0.5, 2, size))
    R = np.array([[2.0, 0.3], [0.3, 1.0]])
    K = continuous_gain(A, B, Q, R)
    expected = np.linalg.solve(R, B.T @ linalg.solve_continuous_are(A, B, Q, R))
    np.testing.assert_allclose(K, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())
    Ad, Bd = held_inputs(A, B, 0.02)
    signal = import_module("scipy.signal")  # Seconds, which other workers need not wait for.
    Ac, Bc, *_ = signal.cont2discrete((A, B, np.eye(size), np.zeros((size, 2))), 0.02)
    np.testing.assert_allclose(Ad, Ac, rtol=1e-11, atol=1e-12 * np.abs(Ac).max())
    np.testing.assert_allclose(Bd, Bc, rtol=1e-10, atol=1e-12 * np.abs(Bc).max())
    if scale == 1.0:
        X = linalg.solve_discrete_are(Ac, Bc, Q, R)
        expected = np.linalg.solve(R + Bc.T @ X @ Bc, Bc.T @ X @ Ac)
        found = sampled_gain(Ad, Bd, Q, R)
        np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("size", [2, 4, 6, 8])
@pytest.mark.parametrize("cost", [1e-8, 0.1, 1e8])
def test_gains_of_integrators_keep_their_digits(size: int, cost: float) -> None:
    """A craft that tilts to move has four in a row. p(s) p(-s) = (-s^2)^n + sum (-s^2)^i/cost, p of the loop."""
    A, B = np.diag(np.ones(size - 1), 1), np.eye(size)[:, -1:]
    found = continuous_gain(A, B, np.eye(size), np.array([[cost]]))
    squares = [(-1.0) ** size, 0.0] + [x for i in reversed(range(size)) for x in ((-1.0) ** i / cost, 0.0)]
    with mpmath.workdps(40):
        poles = [s for s in mpmath.polyroots(squares[:-1], maxsteps=500, extraprec=200) if s.real < 0.0]
        p = [mpmath.mpc(1)]
        for pole in poles:
            p = [a - pole * b for a, b in zip([*p, 0], [0, *p], strict=True)]
    np.testing.assert_allclose(found, [[float(x.real) for x in p[:0:-1]]], rtol=1e-11)


@pytest.mark.parametrize("rates", [(1.0, 2.0), (0.1, 1e4), (1.0, 1e3)])
def test_gains_of_oscillators_are_those_of_each(rates: tuple[float, ...]) -> None:
    """x'' = -w^2 x + u: k = sqrt(w^4 + 1) - w^2 and sqrt(1 + 2 k)."""
    w2 = np.square(rates)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(w2), np.zeros((2, 2))]])
    found = continuous_gain(A, np.eye(4)[:, 2:], np.eye(4), np.eye(2))
    k = 1.0 / (w2 + np.sqrt(w2**2 + 1.0))
    np.testing.assert_allclose(found, np.hstack([np.diag(k), np.diag(np.sqrt(1.0 + 2.0 * k))]), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(("size", "scale", "period"), [(1, 1.0, 0.5), (4, 1.0, 0.3), (4, 30.0, 0.05)])
def test_a_sampled_gain_is_of_what_happens_between_samples(
    size: int, scale: float, period: float, rng: np.random.Generator
) -> None:
    """Against SciPy: the integral over a period by quadrature, the sum of them by its Riccati equation."""
    A, B = scale * rng.normal(size=(size, size)), scale * rng.normal(size=(size, 2))
    weights = linalg.block_diag(np.diag(rng.uniform(0.5, 2, size)), [[2.0, 0.3], [0.3, 1.0]])
    F = np.vstack([np.hstack([A, B]), np.zeros((2, size + 2))])
    nodes, shares = np.polynomial.legendre.leggauss(60)
    moved = [linalg.expm(0.5 * period * (1.0 + node) * F) for node in nodes]
    cost = 0.5 * period * sum(share * E.T @ weights @ E for share, E in zip(shares, moved, strict=True))
    (Q, N), R = np.hsplit(cost[:size], [size]), cost[size:, size:]
    E = linalg.expm(period * F)
    Ad, Bd = E[:size, :size], E[:size, size:]
    X = linalg.solve_discrete_are(Ad, Bd, Q, R, s=N)
    expected = np.linalg.solve(R + Bd.T @ X @ Bd, Bd.T @ X @ Ad + N.T)
    found = held_gain(A, B, weights[:size, :size], weights[size:, size:], period)
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-8 * np.abs(expected).max())


def test_the_block_has_the_gain_of_its_period() -> None:
    model = sf.compile(MODELS["cart_pole"])
    diagram = sf.Diagram("sampled")
    diagram.add_model("m", MODELS["cart_pole"], {"q": 0.0})
    for name in "qv":
        diagram.add(Constant(name=name, value=np.zeros(2)))
    block = LQR(name="lqr", model="m", state_weights=[1, 2, 3, 4], input_weights=0.1, period=0.2)
    diagram.add(block, q="q.y", v="v.y")
    K = block.gain(surroundings(resolve(diagram).wired, "lqr"))
    linear = sf.state_space(model, model.neutral())
    Q = linear.basis.T @ np.diag([1.0, 2.0, 3.0, 4.0]) @ linear.basis
    expected = held_gain(linear.A, linear.B, Q, np.array([[0.1]]), 0.2)
    assert expected is not None
    np.testing.assert_allclose(K @ linear.basis, expected, rtol=1e-9)
    cost = sampled_gain(*held_inputs(linear.A, linear.B, 0.2), Q, np.array([[0.1]]))
    assert np.abs(K @ linear.basis - cost).max() > 1e-2 * np.abs(K).max()  # That of samples alone is another one.


def test_an_unstable_state_that_no_input_reaches_gives_no_gain() -> None:
    A, B = np.diag([1.0, -1.0]), np.array([[0.0], [1.0]])
    assert continuous_gain(A, B, np.eye(2), np.eye(1)) is None
    assert sampled_gain(*held_inputs(A, B, 0.1), np.eye(2), np.eye(1)) is None
    assert held_gain(A, B, np.eye(2), np.eye(1), 0.1) is None


def held_up(name: str, start: dict[str, float], away: dict[str, float], block: LQR, t_end: float) -> np.ndarray:
    """The distance of a model from `start` over time, once it is let go elsewhere under a regulator."""
    system = MODELS[name]
    diagram = sf.Diagram("hold")
    diagram.add_model("m", system, start)
    diagram.add_model("plant", system, {**start, **away})
    diagram.add(block, q="plant.q", v="plant.v")
    diagram.add(ForwardDynamics(name="plant", model="plant"), u="lqr.u")
    simulation = sf.Simulation(diagram)
    found = simulation.run(t_end, dt=1e-3)
    assert found.outcome.ok
    short = simulation.interpret(0.1, dt=1e-3, record=0.01)
    np.testing.assert_allclose(simulation.run(0.1, dt=1e-3, record=0.01)["lqr.u"], short["lqr.u"], rtol=1e-8, atol=1e-9)
    return np.linalg.norm(found["lqr.x"], axis=1)


@pytest.mark.parametrize("period", [None, 0.01])
def test_an_inverted_pendulum_is_held_up(period: float | None) -> None:
    model = sf.compile(MODELS["cart_pole"])
    pole = model.names.q[1]
    upright = max((0.0, np.pi), key=lambda x: model.potential_energy(np.array([0.0, x])))
    block = LQR(name="lqr", model="m", state_weights=[1, 10, 1, 1], input_weights=0.1, period=period)
    distance = held_up("cart_pole", {pole: upright}, {pole: upright + 0.2}, block, 12.0)
    assert distance[0] == pytest.approx(0.2)
    assert distance[-1] < 1e-3


def test_a_first_state_that_does_not_stay_is_noted(tmp_path: Path) -> None:
    """About a pole that leans it holds the cart elsewhere: said by runs, compiled and not, and by exports."""
    model = sf.compile(MODELS["cart_pole"])
    pole = model.names.q[1]
    upright = max((0.0, np.pi), key=lambda x: model.potential_energy(np.array([0.0, x])))
    said = {}
    for lean in (0.0, 0.05):
        diagram = sf.Diagram("hold")
        diagram.add_model("m", MODELS["cart_pole"], {pole: upright + lean})
        diagram.add(LQR(name="lqr", model="m", period=0.01), q="plant.q", v="plant.v")
        diagram.add(ForwardDynamics(name="plant", model="m"), u="lqr.u")
        runs = sf.Simulation(diagram)
        notes = runs.run(0.1).outcome.notes, runs.interpret(0.1, dt=1e-3).outcome.notes
        exported = sf.export(diagram, "c", tmp_path / f"{lean}", outputs=["lqr.u"]).notes
        said[lean] = [
            [note for note in every if "'lqr': model 'm' is not at rest" in note] for every in (*notes, exported)
        ]
    assert said[0.0] == [[], [], []]
    assert all(len(found) == 1 and "' accelerates by" in found[0] for found in said[0.05]), said


@pytest.mark.parametrize(("nominal", "said"), [(2.0 * 9.81, False), (None, True), (0.0, True)])
def test_constant_inputs_that_hold_the_first_state_make_it_a_rest(nominal: float | None, said: bool) -> None:
    """A mass that hangs on its input; without one it falls."""
    slide = sf.Joint("z", "prismatic", axis=(0, 0, 1), actuated=True)
    diagram = sf.Diagram("hold")
    diagram.add_model("m", sf.System("mass", (sf.RigidBody("z", slide, sf.Inertia(2.0)),)))
    given = None if nominal is None else [nominal]
    diagram.add(LQR(name="lqr", model="m", nominal=given), q="plant.q", v="plant.v")
    diagram.add(ForwardDynamics(name="plant", model="m"), u="lqr.u")
    assert ["accelerates by -9.81" in note for note in resolve(diagram).notes] == [True] * said


def test_a_floating_arm_is_regulated_along_its_manifold() -> None:
    # Its base drifts freely: what no force reaches can't be regulated, which is said.
    with pytest.raises(sf.DescriptionError, match="no gain") as caught:
        held_up("space_arm", {}, {}, LQR(name="lqr", model="m"), 0.1)
    assert "actuate more joints" in caught.value.problems[0].remedy


def test_the_gain_in_a_closed_loop_equals_the_gain_in_independent_coordinates() -> None:
    system = crank_driven()
    diagram = sf.Diagram("loop")
    q0 = sf.assemble(sf.compile(system), [1.2, -1.2, 1.2]).q
    diagram.add_model("m", system, dict(zip(("q1", "q2", "q3"), q0, strict=True)))
    for name, size in (("q", 3), ("v", 3)):
        diagram.add(Constant(name=name, value=np.zeros(size)))
    block = LQR(name="lqr", model="m", state_weights=[1, 2, 3, 4, 5, 6], input_weights=0.5)
    diagram.add(block, q="q.y", v="v.y")
    wired = resolve(diagram).wired
    K = block.gain(surroundings(wired, "lqr"))
    linear = sf.state_space(sf.compile(system), q0)
    X = linalg.solve_continuous_are(linear.A, linear.B, linear.basis.T @ np.diag(range(1, 7)) @ linear.basis, [[0.5]])
    np.testing.assert_allclose(K @ linear.basis, linear.B.T @ X / 0.5, rtol=1e-7)
    assert K.shape == (1, 6)


def crank_driven() -> sf.System:
    """The four-bar linkage with a motor at its crank."""
    system = MODELS["four_bar"]
    crank = system.bodies[0]
    assert crank.joint is not None
    return system.with_bodies(replace(crank, joint=replace(crank.joint, actuated=True)), *system.bodies[1:])


@pytest.mark.parametrize(
    ("fields", "found"),
    [
        ({"state_weights": np.eye(4) + np.eye(4, k=1)}, "mirrored ones by up to 1"),
        ({"state_weights": [1, 2]}, "(2,)"),
        ({"input_weights": 0.0}, "0"),
        ({"model": "dead"}, "no inputs"),
    ],
)
def test_invalid_lqr_designs_are_refused(fields: dict[str, Any], found: str) -> None:
    diagram = sf.Diagram("one")
    diagram.add_model("m", MODELS["cart_pole"])
    diagram.add_model("dead", MODELS["torque_free_body"])
    diagram.add(Constant(name="x", value=[0.0, 0.0]))
    diagram.add(LQR(**{"name": "lqr", "model": "m", **fields}), q="x.y", v="x.y")
    refused(lambda: sf.Simulation(diagram), found)
