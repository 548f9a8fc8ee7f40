"""Loops with conditions that repeat others on the constraints alone move as they should, by every method and step."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import compiled
from tests.overconstrained import Bennett, sarrus
from tests.simulation.mechanisms import loop

START, RATE, END = 0.5, 1.5, 2.9  # The way of the first hinge leads past pi, where two rows of G vanish.
# Methods, their steps, and the angle [rad] by which they may be off: of fixed steps a bound of the order of the
# method's error on a smooth motion, of adaptive ones a small multiple of their tolerance of 1e-6.
METHODS = (
    *(("rk4", dt, 1e-7 if dt < 0.01 else 1e-5) for dt in (2e-2, 5e-3, 1e-3)),
    *((method, None, 2e-5) for method in ("dopri5", "dop853", "rodas4")),
    *(("generalized_alpha", dt, dt) for dt in (5e-3, 1e-3)),
)
DRAWN = range(2)


@cache
def linkage(seed: int) -> tuple[Bennett, sf.Model]:
    """Bennett's linkage of random proportions."""
    bennett = Bennett.drawn(np.random.default_rng(seed))
    return bennett, sf.compile(bennett.system())


@pytest.mark.parametrize("seed", DRAWN)
@pytest.mark.parametrize(("method", "dt", "bound"), METHODS)
def test_bennetts_linkage_moves_as_its_energy_says(method: str, dt: float | None, bound: float, seed: int) -> None:
    """G has two independent rows on the constraints and three beside them: no stage may take the third one for more."""
    bennett, model = linkage(seed)
    q, v = bennett.posture(START), bennett.speeds(START, RATE)
    run = sf.simulate(model, q, v, END, method=method, **({} if dt is None else {"dt": dt}))
    assert run.outcome.kind == "finished"
    assert not run.outcome.notes
    assert abs(bennett.late(model, START, RATE, float(run.q[-1, 0]), END)) < bound


def test_a_batch_and_the_interpreter_give_the_same_motion() -> None:
    """The rank is decided in the function itself: whoever calls it gets the same motion."""
    bennett, model = linkage(0)
    q, v = bennett.posture(START), bennett.speeds(START, RATE)
    alone = sf.simulate(model, q, v, END, dt=1e-2)
    several = sf.simulate_batch(model, np.array([q, q]), np.array([v, v]), END, dt=1e-2)
    assert np.allclose(several.q[:, -1], alone.q[-1], rtol=0, atol=1e-12)
    interpreted = sf.compile(bennett.system(), sf.Options(backend="interpreter"))
    for h in (1e-1, 1e-2, 1e-3):
        beside = q + h * v
        a, lam = (m.forward_dynamics(beside, v, [], multipliers=True) for m in (model, interpreted))
        for one, other in zip(a, lam, strict=True):
            # Beside the constraints their rows contradict each other by some h^2, and the forms weigh that differently.
            assert np.allclose(one, other, rtol=0, atol=h * h)


@pytest.mark.parametrize("backend", ["c", "interpreter"])
def test_far_from_the_constraints_the_conditions_there_are_met(backend: str) -> None:
    """A state that no drift has left asks for the rank that G has at it: phi'' = 0 holds of all conditions."""
    model = sf.compile(MODELS["bricard"], sf.Options(backend=backend))
    rng, met = np.random.default_rng(0), 0
    closed = sf.assemble(model).q
    for _ in range(120):
        q, v = closed + rng.uniform(-0.15, 0.15, model.nq), rng.uniform(-1, 1, model.nv)
        strengths = np.linalg.svd(model.constraint_jacobian(q), compute_uv=False)
        if strengths[-1] > 1e-4 * strengths[0] and np.abs(model.constraint(q)).max() > 0.05:
            a = model.forward_dynamics(q, v, [])
            missed = np.abs(model.constraint_jacobian(q) @ a - model.constraint_bias(q, v)).max()
            assert missed < 1e-6 * (1.0 + np.abs(a).max()), q
            met += 1
    assert met > 20


@pytest.mark.parametrize("constraints", ["multipliers", "null_space"])
def test_accelerations_beside_the_constraints_are_those_on_them(constraints: str) -> None:
    """They differ by as much as the states do; a lock would make them differ by themselves."""
    bennett = linkage(1)[0]
    model = sf.compile(bennett.system(), sf.Options(constraints=constraints))
    rng = np.random.default_rng(7)
    for _ in range(40):
        angle, size = rng.uniform(-3, 3), 10.0 ** rng.uniform(-8, -3)
        q, v = bennett.posture(angle), bennett.speeds(angle, RATE)
        on = model.forward_dynamics(q, v, [])
        beside = model.forward_dynamics(q + size * rng.uniform(-1, 1, 3), v, [])
        # The motion's own scale over the shares of rows that count, some hundredths at the least.
        assert np.abs(beside - on).max() < 1e3 * size * (1.0 + np.abs(on).max())


@pytest.mark.parametrize("constraints", ["multipliers", "null_space"])
def test_speed_conditions_beside_a_redundant_loop_do_not_affect_its_projection(constraints: str) -> None:
    """The rank is that of the posture on the constraints: a knife edge has none, and still binds the sleigh."""
    bennett = linkage(1)[0]
    sleigh = sf.RigidBody("sleigh", sf.Joint("s", "planar"), sf.Inertia(2.0, (0.3, 0, 0), (0.1, 0.1, 0.15)))
    edge = sf.KnifeEdge("edge", ("sleigh", None), "y")
    loop = bennett.system()
    both = sf.System("both", (*loop.bodies, sleigh), constraints=(edge, *loop.constraints), gravity=(0, 0, 0))
    alone = sf.compile(sf.System("alone", (sleigh,), constraints=(edge,), gravity=(0, 0, 0)))
    model, by_itself = (sf.compile(system, sf.Options(constraints=constraints)) for system in (both, loop))
    rng = np.random.default_rng(11)
    for _ in range(10):
        angle, size = rng.uniform(-3, 3), 10.0 ** rng.uniform(-6, -3)
        beside = bennett.posture(angle) + size * rng.uniform(-1, 1, 3)
        v, heading, forward, turn = bennett.speeds(angle, RATE), *rng.uniform(-1, 1, 3)
        q_sleigh, v_sleigh = [0.4, -0.2, heading], [forward * np.cos(heading), forward * np.sin(heading), turn]
        a = model.forward_dynamics([*beside, *q_sleigh], [*v, *v_sleigh], [])
        expected = [*by_itself.forward_dynamics(beside, v, []), *alone.forward_dynamics(q_sleigh, v_sleigh, [])]
        np.testing.assert_allclose(a, expected, rtol=0, atol=1e-9 * (1.0 + np.abs(expected).max()))


def test_bricards_linkage_gets_no_note() -> None:
    """Five conditions of rank four; right, and so nothing is said of modes or singular postures."""
    model = compiled("bricard")
    fine = sf.simulate(model, t_end=2.0, method="dop853", rtol=1e-11, atol=1e-12)
    for settings in ({"dt": 5e-3}, {"dt": 1e-3}, {"method": "dopri5"}):
        run = sf.simulate(model, t_end=2.0, **settings)
        assert not run.outcome.notes, (settings, run.outcome.notes)
        assert np.abs(run.q[-1] - fine.q[-1]).max() < 1e-5


@pytest.mark.parametrize(
    ("method", "dt", "bound"),
    [
        ("rk4", 2e-2, 1e-5),
        ("rk4", 1e-3, 1e-9),
        ("dopri5", None, 1e-5),
        ("generalized_alpha", 1e-3, 1e-5),
        ("ida", None, 1e-5),
    ],
)
def test_sarrus_linkage_moves_as_one_on_a_slide(method: str, dt: float | None, bound: float) -> None:
    """Five conditions of rank four, against two conditions a chain and a slide: the same platform."""
    full, slide = (sf.compile(sarrus(by_slide)) for by_slide in (False, True))
    a = 1.1
    start = {"a1": a, "a2": np.pi - 2 * a, "b1": a, "b2": np.pi - 2 * a}
    one = sf.assemble(slide, start | {"z": np.sin(a)}, {"a1": 0.8}, held=("a1",))
    other = sf.assemble(full, start | {"a3": a - np.pi}, {"a1": 0.8}, held=("a1",))
    exact = sf.simulate(slide, one.q, one.v, 0.4, method="dop853", rtol=1e-11, atol=1e-12)
    run = sf.simulate(full, other.q, other.v, 0.4, method=method, **({} if dt is None else {"dt": dt}))  # type: ignore[arg-type]
    assert run.outcome.kind == "finished" and not run.outcome.notes
    for name in start:
        assert abs(run[name][-1] - exact[name][-1]) < bound


@pytest.mark.parametrize(("method", "dt"), [("rk4", 1e-2), ("rodas4", None), ("generalized_alpha", 2e-3)])
def test_planar_loops_closed_in_space_move_as_those_closed_in_their_plane(method: str, dt: float | None) -> None:
    """Three conditions too many repeat others everywhere, and void ones are no conditions."""
    ends = []
    for rows in ((("x", "z"), ()), (("x", "y", "z"), ("x", "z"))):
        model = sf.compile(loop((1.0, 1.0, 1.0), 1.3, (0, 1, 0), rows=rows))
        start = sf.assemble(model, {"q1": -1.2, "q2": 1.2, "q3": -1.0}, held=("q1",))
        run = sf.simulate(model, start.q, start.v, 1.0, method=method, **({} if dt is None else {"dt": dt}))  # type: ignore[arg-type]
        assert run.outcome.kind == "finished" and not run.outcome.notes
        ends.append(run.q[-1])
    assert np.abs(ends[0] - ends[1]).max() < 1e-6
