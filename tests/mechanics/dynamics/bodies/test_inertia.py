"""Regrouping moves inertia between links and changes nothing that can be measured."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.expr.edges import ZERO
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import interpret
from symofros.expr.program import Function, Output, Program
from symofros.mechanics.dynamics.bodies.inertia import _stated, link_inertias
from symofros.mechanics.dynamics.energy import kinetic_energy, potential_energy
from symofros.mechanics.dynamics.jourdain import inertia_forces
from symofros.mechanics.dynamics.mass_matrix import mass_matrix
from symofros.mechanics.kinematics.links import tree_kinematics
from symofros.mechanics.spatial.inertia import LinkInertia, no_inertia
from symofros.mechanics.topology.tree import build_tree
from tests.models import CASES, sampled, system


def evaluated(case: str, regrouped: bool, q: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
    """M, h, T, V of a case, with or without regrouping."""
    tree = build_tree(system(case))
    kinematics = tree_kinematics(Graph(), tree)
    g = kinematics.g
    if regrouped:
        inertias, base = link_inertias(kinematics)
    else:
        inertias, base = [_stated(kinematics, i) for i in range(len(kinematics.links))], no_inertia(g)
    gravity = kinematics.lowering.vector(tree.system.gravity)
    M = mass_matrix(kinematics, inertias, [])
    h = inertia_forces(kinematics, inertias, [], [ZERO] * kinematics.nv, gravity)
    T, V = kinetic_energy(kinematics, inertias, []), potential_energy(kinematics, inertias, base, gravity)
    edges = (*(edge for row in M.entries for edge in row), *h, T, V)
    function = Function("all", "", ("q", "v"), (Output("x", (len(edges),), edges),))
    program = Program("p", g, {}, (function,))
    par = np.array([tree.coordinates.par_default])
    return interpret(program, function, {"q": q, "v": v, "par": par}, len(q))


@pytest.mark.parametrize("case", sampled(CASES))
def test_regrouping_changes_no_output(case: str, rng: np.random.Generator) -> None:
    model = sf.compile(system(case), sf.Options(backend="interpreter"))
    pairs = [model.random_state(rng) for _ in range(20)]
    q, v = np.array([q for q, _ in pairs]), np.array([v for _, v in pairs])
    (plain,), (moved,) = evaluated(case, False, q, v), evaluated(case, True, q, v)
    np.testing.assert_allclose(moved, plain, atol=1e-12 * np.abs(plain).max())


def test_a_revolute_link_keeps_the_minimal_set() -> None:
    """Seven numbers stay: S_x, S_y, J_xx, J_zz, J_xy, J_xz, J_yz (docs/theory/rigid.md, eq. 17)."""
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia("m", ("x", "y", "z"), tuple("abcdef"), about="body"))
    stated = sf.System("s", [body], [sf.Parameter(name, 1.0) for name in "mxyzabcdef"])
    # Physical or not does not matter here.
    tree = build_tree(
        sf.System("s", [sf.RigidBody("b", body.joint, body.inertia, (), ["nonphysical_inertia"])], stated.parameters)
    )
    (kept,), base = link_inertias(tree_kinematics(Graph(), tree))
    assert kept.m == ZERO and kept.mp_LLcm.z == ZERO and kept.I_LLo_L.yy == ZERO
    S, J = kept.mp_LLcm, kept.I_LLo_L
    assert all(edge != ZERO for edge in (S.x, S.y, J.xx, J.zz, J.xy, J.xz, J.yz))
    assert base.m != ZERO and base.mp_LLcm.z != ZERO


def test_a_sliding_link_keeps_mass_and_first_moment() -> None:
    body = sf.RigidBody("b", sf.Joint("q", "prismatic"), sf.Inertia(2.0, (0.1, 0.2, 0.3), (20, 20, 20), about="body"))
    (kept,), _ = link_inertias(tree_kinematics(Graph(), build_tree(sf.System("s", [body]))))
    assert all(edge == ZERO for edge in kept.I_LLo_L)
    assert isinstance(kept, LinkInertia) and kept.m != ZERO and not kept.mp_LLcm.is_zero
