"""Articulated bodies against the factors of M: the same accelerations, linear growth, digits kept under heavy loads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from reference_models.rigid.chain import INERTIAL, chain
from reference_models.rigid.random_tree import MORE_KINDS, SERIES_KINDS, random_tree
from symofros.base.routes import taken
from symofros.description.forces import Rotor
from symofros.expr.numerics.precise import evaluate_precisely
from symofros.expr.program import Program
from symofros.generator.codegen.interpreted import InterpretedUnit
from symofros.generator.passes import run_passes
from symofros.generator.passes.count import Operations, count_program
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.functions import Methods, Request, form_program
from symofros.mechanics.topology.tree import build_tree
from tests.mechanics.beams.cases import CASES
from tests.models import sampled

Way = Literal["articulated", "factors"]
WAYS: tuple[Way, ...] = ("articulated", "factors")
NAME = "forward_dynamics"
# Reference models with constraints, named because reading all models to ask them takes two seconds of collection.
CLOSED = (
    "andrews_squeezer docking flexible_slider_crank four_bar parallelogram rolling_disc sleigh slider_crank"
    " bricard stewart delta delta_rods two_four_bars grasp two_arms"
).split()
TREES = tuple(name for name in MODELS if name not in CLOSED)
# Those that take a second or more to generate.
LARGE = tuple(name for name in TREES if name.endswith(("mss", "spdm", "ssrms")) or name.startswith("chain2"))
# Rounding times the condition of M: up to 3e7 among the reference models.
TOLERANCE = 1e-10
SOLID = sf.Inertia(1.0, (0.2, 0.1, -0.3), (1.0, 1.2, 0.9))


def interpreted(system: sf.System, way: Way) -> sf.Model:
    return sf.compile(system, sf.Options((NAME,), (), backend="interpreter", forward_dynamics=way))


def difference(system: sf.System, seed: int = 0) -> float:
    """Difference of the two methods relative to the largest acceleration; prescribed motions by default."""
    rng = np.random.default_rng(seed)
    models = [interpreted(system, way) for way in WAYS]
    q, v = (np.array(x) for x in zip(*(models[0].random_state(rng) for _ in range(4)), strict=True))
    u = np.array(models[0].record.u_default) + np.zeros((4, models[0].nu))
    efforts = build_tree(system).coordinates.efforts
    u[:, :efforts] = rng.uniform(-1.0, 1.0, (4, efforts))
    one, other = (model.forward_dynamics(q, v, u) for model in models)
    return float((np.abs(one - other).max(-1) / np.abs(other).max(-1)).max())


@pytest.mark.parametrize("name", sampled(TREES, [name for name in TREES if name not in LARGE]))
def test_articulated_bodies_accelerate_reference_models_as_factors_do(name: str) -> None:
    """Flexible arms, rotors, springs and loads among them."""
    assert not MODELS[name].constraints
    assert difference(MODELS[name]) < TOLERANCE


@settings(max_examples=12)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 8))
def test_articulated_bodies_accelerate_random_trees_as_factors_do(seed: int, n: int) -> None:
    """Joints of every kind, the user's own among them."""
    assert difference(random_tree(seed, n, (*MORE_KINDS, *SERIES_KINDS)), seed) < TOLERANCE


@pytest.mark.filterwarnings("ignore::symofros.InconsistentModelWarning")  # One is without foreshortening on purpose.
@pytest.mark.parametrize("retain", sampled(("zeroth_order", "first_order", "all"), ["first_order"]))
@pytest.mark.parametrize("case", CASES)
def test_articulated_bodies_accelerate_beams_as_factors_do(case: str, retain: str) -> None:
    """In series, branching, with bodies on their tips, on a driven base."""
    assert difference(CASES[case].retaining(retain)) < TOLERANCE


@pytest.mark.parametrize("seed", range(4))
def test_a_prescribed_motion_inside_a_tree_matches_the_factors(seed: int, rng: np.random.Generator) -> None:
    stated = random_tree(900 + seed, kinds=("revolute", "prismatic", "universal", "ball"))
    body = next(b for b in stated.bodies[2:] if b.joint is not None and b.joint.kind != "ball")
    assert body.joint is not None
    driven = stated.with_bodies(replace(body, joint=replace(body.joint, prescribed=True, actuated=False)))
    models = [interpreted(driven, way) for way in WAYS]
    q, v = models[0].random_state(rng)
    u = rng.uniform(-1.0, 1.0, models[0].nu)  # Coordinates, speeds and rates of the motion among them.
    one, other = (model.forward_dynamics(q, v, u) for model in models)
    np.testing.assert_allclose(one, other, rtol=0, atol=TOLERANCE * np.abs(other).max())


def geared(carrier: str | None) -> sf.System:
    """Three links, a rotor that the last joint drives."""
    rotor = Rotor(2e-3, 30.0, (0.3, 0.4, 0.8), carrier)
    bodies = [
        sf.RigidBody(
            f"b{i}",
            sf.Joint(
                f"q{i}",
                "revolute",
                f"b{i - 1}" if i else "world",
                position=(0.3, 0.1, 0.2),
                axis=(1, i, -i),
                rotors=(rotor,) if i == 2 else (),
            ),
            SOLID,
        )
        for i in range(3)
    ]
    return sf.System("geared", bodies)


@pytest.mark.parametrize("carrier", ["b1", "world"])
def test_rotors_on_the_parent_or_at_rest_stay_local(carrier: str) -> None:
    assert Equations(build_tree(geared(carrier))).route_figures["distant_rotors"] == 0
    assert difference(geared(carrier)) < TOLERANCE


@pytest.mark.parametrize("carrier", ["b0", "b2"])
def test_rotors_on_a_third_body_need_the_factors(carrier: str) -> None:
    """Its own link counts as one: the rotor turns with what it drives."""
    (choice,) = sf.compile(geared(carrier), sf.Options(backend="interpreter")).routes[NAME]
    assert choice.method == "factors" and choice.figures == {"distant_rotors": 1.0} and choice.others == ()
    with pytest.raises(sf.DescriptionError, match=r"rotor.*\n.*\n.*remedy.*'factors'"):
        interpreted(geared(carrier), "articulated")


def massless(system: sf.System, way: Way) -> str:
    with pytest.raises(sf.DescriptionError) as caught:
        interpreted(system, way)
    return str(caught.value)


def test_both_methods_refuse_the_same_massless_speeds() -> None:
    """A speed that moves no mass, and two that move the same mass alike."""
    tip = sf.RigidBody("b", sf.Joint("q2", "revolute", "a"), None, waive=("massless_tip",))
    light = sf.System("s", (sf.RigidBody("a", sf.Joint("q1", "revolute"), SOLID), tip))
    between = sf.RigidBody("a", sf.Joint("q1", "revolute"), None)
    same_mass = sf.System("s", (between, sf.RigidBody("b", sf.Joint("q2", "revolute", "a"), SOLID)))
    for system, words in ((light, "speed 'q2' moves no mass"), (same_mass, "speed 'q1' moves nothing that")):
        assert words in massless(system, "articulated")
        assert massless(system, "articulated") == massless(system, "factors")


@cache
def by(way: Way) -> Methods:
    return Methods(taken("acceleration of trees", way))


def program(links: int, way: Way) -> Program:
    """Forward dynamics of a chain whose inertias are run-time parameters."""
    return run_passes(form_program(Equations(build_tree(chain(links))), [Request(NAME)], by(way)))


def counted(links: int, way: Way) -> Operations:
    return count_program(program(links, way))[NAME, ""]


@pytest.mark.slow
def test_operations_grow_in_proportion_to_the_links() -> None:
    """Recursion: operations grow as n; those of the factors tend to n^3, and take n^2 to form M."""
    grown = {way: np.log2(counted(52, way).total / counted(26, way).total) for way in WAYS}
    assert grown["articulated"] == pytest.approx(1.0, abs=0.05)
    assert grown["factors"] > 2.2


@cache
def error(links: int, way: Way, load: float) -> float:
    """Error of accelerations in doubles against forty digits: the geometric mean over states.

    The last link is so many times as heavy as it was.
    """
    heavy = {f"{name}{links}" for name in INERTIAL if name[0] in "mI"}
    par = np.array([p.value * (load if p.name in heavy else 1.0) for p in chain(links).parameters], dtype=float)
    ours = program(links, way)
    kernel, exact = InterpretedUnit(ours).kernels[NAME, ""], program(links, "articulated")
    rng, errors = np.random.default_rng(links), []
    for _ in range(4):
        given = {"q": rng.uniform(-1.0, 1.0, links), "v": rng.uniform(-1.0, 1.0, links), "u": np.zeros(links)}
        given |= {"t": np.zeros(1), "par": par}
        expected = np.array(evaluate_precisely(exact, exact.functions[0], given, 40)[0], dtype=float)
        a = kernel.run(1, kernel.prepare(par[None]), [given[name][None] for name, _ in kernel.signature.inputs])[0][0]
        errors.append(np.abs(a - expected).max() / np.abs(expected).max())
    return float(np.exp(np.mean(np.log(errors))))


def test_articulated_bodies_stay_accurate_in_long_chains() -> None:
    """Twice the links: factors lose a digit more (n^4), articulated bodies nothing to speak of (below n)."""
    lost = {way: np.log2(error(16, way, 1.0) / error(8, way, 1.0)) for way in WAYS}
    assert lost["articulated"] < 1.0
    assert lost["factors"] > 3.0


def test_articulated_bodies_lose_fewer_digits_under_heavy_loads() -> None:
    """Both lose in proportion to the load on sixteen links, from levels that lie hundreds of times apart."""
    for way in WAYS:
        slope = np.log10(error(16, way, 1e8) / error(16, way, 1e4)) / 4.0
        assert slope == pytest.approx(1.0, abs=0.25)
    assert error(16, "factors", 1e8) > 100.0 * error(16, "articulated", 1e8)
    assert error(16, "articulated", 1e8) < 1e-7


@pytest.mark.parametrize(
    ("make", "way"),
    [
        (lambda: MODELS["puma560"], "factors"),
        (lambda: MODELS["chain7"], "factors"),
        pytest.param(lambda: MODELS["joint_zoo"], "factors", marks=pytest.mark.slow),
        (lambda: MODELS["planar_robot"], "articulated"),
        pytest.param(lambda: MODELS["mss"], "articulated", marks=pytest.mark.slow),
        pytest.param(lambda: MODELS["flexible_arm"], "articulated", marks=pytest.mark.slow),
        pytest.param(lambda: chain(32), "articulated", marks=pytest.mark.slow),
    ],
)
def test_auto_selects_the_faster_method(make: Callable[[], sf.System], way: Way) -> None:
    """docs/theory/code.md, section 2, states the times."""
    system = make()
    ours = count_program(sf.program_of(system, [NAME]))[NAME, ""]
    alone = run_passes(form_program(Equations(build_tree(system)), [Request(NAME)], by(way)))
    assert ours == count_program(alone)[NAME, ""]
    other = run_passes(form_program(Equations(build_tree(system)), [Request(NAME)], by(WAYS[way == "articulated"])))
    assert ours != count_program(other)[NAME, ""]
