"""Derivatives of inverse dynamics by recursion: against the differentiated graph, and what they must not depend on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from reference_models import MODELS
from reference_models.rigid.chain import chain
from symofros.base.functions import INPUTS
from symofros.expr.edges import Edge
from symofros.expr.numerics.evaluate import evaluate_edges, needed_nodes
from symofros.expr.program import Program
from symofros.mechanics.dynamics.derivatives.differentiation import by_configuration, by_inputs
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.topology.tree import build_tree
from tests.models import SAMPLE, model, system

# "gyroscope" and "friction_arm" bear rotors or friction: the one is differentiated, the other recursive with elements.
RECURSIVE = tuple(name for name in SAMPLE if name != "gyroscope")
Matrix = list[list[Edge]]


def both(e: Equations) -> tuple[tuple[Matrix, Matrix], tuple[Matrix, Matrix]]:
    """Derivatives by q and by v, by recursion and by differentiation of the graph."""
    recursive = e.inverse_dynamics_by_q, e.inverse_dynamics_by_v
    tau = e.inverse_dynamics
    return recursive, (by_configuration(e.kinematics, tau), by_inputs(e.kinematics, tau, "v", e.nv))


def numbers(e: Equations, matrix: Matrix, state: dict[str, np.ndarray]) -> np.ndarray:
    program = Program("", e.g, dict.fromkeys(INPUTS, 0), ())
    edges = [edge for row in matrix for edge in row]
    inputs = {group: np.atleast_2d(values) for group, values in state.items()}
    return np.array([np.asarray(x).item() for x in evaluate_edges(program, edges, inputs, {})]).reshape(e.nv, -1)


@pytest.mark.parametrize("name", RECURSIVE)
def test_recursive_derivatives_match_the_graph(name: str, rng: np.random.Generator) -> None:
    """Each kind of joint, branches, parameters, several speeds of a joint, at states that move and turn."""
    e, m = Equations(build_tree(system(name))), model(name, "interpreter")
    assert e.slopes_route.method == "recursion"
    q, v = m.random_state(rng)
    state = {"q": q, "v": v, "a": rng.normal(size=m.nv), "par": np.array(m.record.par_default), "t": np.zeros(1)}
    for recursive, differentiated in zip(*both(e), strict=True):
        expected = numbers(e, differentiated, state)
        error = np.abs(numbers(e, recursive, state) - expected).max()
        assert error <= 1e-13 * m.nv * max(1.0, np.abs(expected).max())


def test_a_fast_moving_base_does_not_reduce_accuracy(rng: np.random.Generator) -> None:
    """What a steady flight of 10 km/s changes is nothing, to the digits of a robot at rest."""
    m = model("space_arm", "interpreter")
    q, v = m.random_state(rng)
    v[:6], a = 0.0, rng.normal(size=m.nv)
    flying = v + 1e4 * np.eye(m.nv)[0]
    arm = slice(6, None)
    for at_rest, in_flight in zip(
        m.inverse_dynamics_derivatives(q, v, a), m.inverse_dynamics_derivatives(q, flying, a), strict=True
    ):
        assert np.abs(in_flight - at_rest)[arm, arm].max() <= 1e-14 * np.abs(at_rest[arm, arm]).max()


def test_a_rotor_on_a_moving_link_uses_the_graph() -> None:
    e = Equations(build_tree(MODELS["gyroscope"]))
    assert e.slopes_route.method == "graph"
    recursive, differentiated = both(e)
    assert recursive == differentiated


def operations(e: Equations, matrices: Sequence[Matrix]) -> int:
    return len(needed_nodes(e.g, [edge for matrix in matrices for row in matrix for edge in row]))


def test_a_pair_of_speeds_costs_a_bounded_number_of_operations() -> None:
    """Along a chain in space, parameters as numbers: n links by themselves, n^2/2 pairs; a third of the graph's."""
    counts = []
    for n in (6, 9, 12):
        recursive, differentiated = both(e := Equations(build_tree(chain(n, symbolic=False))))
        counts.append(operations(e, recursive))
    assert counts[2] - 2 * counts[1] + counts[0] < 110 * 3**2
    assert counts[2] < operations(e, differentiated) / 2
