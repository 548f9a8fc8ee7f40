"""Derivatives by articulated bodies: those by the factors, with the digits that articulated bodies keep."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from reference_models.rigid.chain import INERTIAL, chain
from reference_models.rigid.random_tree import MORE_KINDS, SERIES_KINDS, random_tree
from symofros.base.functions import FUNCTIONS
from symofros.base.routes import taken
from symofros.compiler import Compilation
from symofros.expr.numerics.precise import evaluate_precisely
from symofros.expr.program import Program
from symofros.generator.codegen.interpreted import InterpretedUnit
from symofros.generator.passes import run_passes
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.functions import Methods, Request, form_program
from symofros.mechanics.topology.tree import build_tree
from tests.mechanics.beams.cases import CASES
from tests.models import sampled

SLOPES, REVERSE, BY_PAR = "forward_dynamics_derivatives", "forward_dynamics_vjp", "forward_dynamics_by_par"
FOLLOWING = ("forward_dynamics", SLOPES, REVERSE, BY_PAR)
WAYS = {"factors": Methods(), "articulated": Methods(taken("acceleration of trees", "articulated"), "articulated")}
# Small trees of every kind: free and ball joints, prescribed motions, rotors, springs, run-time parameters, beams.
TREES = ("double_pendulum", "gyroscope", "friction_arm", "space_arm", "planar_robot", "heavy_top", "joint_zoo")
# Rounding times the condition of M.
TOLERANCE = 1e-9
LINKS = 7
LOADS = (1.0, 1e3, 1e9)


def options(way: str, names: tuple[str, ...] = (SLOPES, BY_PAR), backend: str = "interpreter") -> sf.Options:
    return sf.Options(names, (), backend=backend, forward_dynamics=way)  # type: ignore[arg-type]


def difference(system: sf.System, seed: int = 0) -> float:
    """Largest difference of the two ways in any derivative at some states, relative to its largest entry."""
    models = [sf.compile(system, options(way)).with_parameter_checks(False) for way in WAYS]
    rng = np.random.default_rng(seed)
    q, v = (np.array(x) for x in zip(*(models[0].random_state(rng) for _ in range(3)), strict=True))
    u = np.array(models[0].record.u_default) + rng.uniform(-0.1, 0.1, (3, models[0].nu))
    found = [[*m.evaluate(SLOPES, q=q, v=v, u=u), *m.evaluate(BY_PAR, q=q, v=v, u=u)] for m in models]
    pairs = [(one, other) for one, other in zip(*found, strict=True) if one.size]
    return max(float(np.abs(one - other).max() / max(1.0, np.abs(other).max())) for one, other in pairs)


@pytest.mark.parametrize("name", sampled(TREES, TREES[:3]))
def test_both_ways_give_the_same_derivatives_of_reference_models(name: str) -> None:
    assert difference(MODELS[name]) < TOLERANCE


@settings(max_examples=6)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 4))
def test_both_ways_give_the_same_derivatives_of_random_trees(seed: int, n: int) -> None:
    assert difference(random_tree(seed, n, (*MORE_KINDS, *SERIES_KINDS)), seed) < TOLERANCE


@pytest.mark.filterwarnings("ignore::symofros.InconsistentModelWarning")  # One is without foreshortening on purpose.
@pytest.mark.parametrize("case", sampled(list(CASES), list(CASES)[:3]))
def test_both_ways_give_the_same_derivatives_of_beams(case: str) -> None:
    assert difference(CASES[case].retaining("first_order")) < TOLERANCE


@cache
def program(name: str, way: str) -> Program:
    """A function of a chain whose inertias are run-time parameters."""
    return run_passes(form_program(Equations(build_tree(chain(LINKS))), [Request(name)], WAYS[way]))


@cache
def errors(load: float) -> dict[tuple[str, str], np.ndarray]:
    """Errors of da/dq, da/dv and da/du against 60 digits by (function, way): geometric means over states.

    The last link is so many times as heavy as it was; reverse mode gives the same matrices row by row.
    """
    heavy = {f"{name}{LINKS}" for name in INERTIAL if name[0] in "mI"}
    par = np.array([p.value * (load if p.name in heavy else 1.0) for p in chain(LINKS).parameters], dtype=float)
    rng, found, exact = np.random.default_rng(1), dict[tuple[str, str], list[list[float]]](), program(SLOPES, "factors")
    for _ in range(3):
        given = {"q": rng.uniform(-1.0, 1.0, LINKS), "v": rng.uniform(-1.0, 1.0, LINKS), "u": np.zeros(LINKS)}
        given |= {"t": np.zeros(1), "par": par, "lam_bar": np.zeros(0)}
        truth = [np.array(x, dtype=float) for x in evaluate_precisely(exact, exact.functions[0], given, 60)]
        truth = [x.reshape(LINKS, LINKS) for x in truth]
        for way in WAYS:
            forward = [x.reshape(LINKS, LINKS) for x in called(SLOPES, way, given)]
            rows = [called(REVERSE, way, given | {"a_bar": row}) for row in np.eye(LINKS)]
            reverse = [np.array(of) for of in zip(*rows, strict=True)][: len(truth)]
            for name, matrices in ((SLOPES, forward), (REVERSE, reverse)):
                apart = [np.abs(x - y).max() / np.abs(y).max() for x, y in zip(matrices, truth, strict=True)]
                found.setdefault((name, way), []).append(apart)
    return {key: np.exp(np.mean(np.log(values), axis=0)) for key, values in found.items()}


def called(name: str, way: str, given: dict[str, np.ndarray]) -> list[np.ndarray]:
    kernel = InterpretedUnit(program(name, way)).kernels[name, ""]
    arguments = [given[group][None] for group, _ in kernel.signature.inputs]
    return [array[0] for array in kernel.run(1, kernel.prepare(given["par"][None]), arguments)]


@pytest.mark.parametrize("load", LOADS)
def test_forward_mode_errs_at_most_twice_as_much_as_reverse_mode(load: float) -> None:
    """Twice the reverse mode's error at most, whatever the load."""
    of = errors(load)
    assert (of[SLOPES, "articulated"] <= 2.0 * of[REVERSE, "articulated"]).all()
    assert (of[SLOPES, "articulated"] < of[SLOPES, "factors"]).all()


def test_errors_grow_in_proportion_to_the_load_from_a_lower_level() -> None:
    """By exponents: both as the ratio of masses, the factors of M some times above by q and v, ten times by u."""
    for way in WAYS:
        slopes = np.log10(errors(LOADS[-1])[SLOPES, way] / errors(LOADS[1])[SLOPES, way]) / 6.0
        np.testing.assert_allclose(slopes, 1.0, atol=0.2)
    gained = errors(LOADS[-1])[SLOPES, "factors"] / errors(LOADS[-1])[SLOPES, "articulated"]
    assert (gained > (2.0, 4.0, 10.0)).all()


def test_the_forward_dynamics_option_affects_no_other_function() -> None:
    """Forming all others by either way gives one program; what is solved by M is said in `Options`."""
    system = MODELS["double_pendulum"]
    others = tuple(name for name, row in FUNCTIONS.items() if name not in FOLLOWING and not row.of_frame)
    others = tuple(name for name in others if not FUNCTIONS[name].constrained_only)
    texts = {way: Compilation(system, options(way, others)).source() for way in WAYS}
    lines = [text.splitlines() for text in texts.values()]
    differing = [x for x, y in zip(*lines, strict=True) if x != y]
    assert [x for x in differing if "hash" not in x and "SYM_ABI" not in x] == []  # The hash covers the options.
