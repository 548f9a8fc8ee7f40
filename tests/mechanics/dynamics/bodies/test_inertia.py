"""What regrouping leaves of a link's inertia; that it changes no motion is in tests/reference/test_projection.py."""

from __future__ import annotations

import symofros as sf
from symofros.expr.edges import ZERO
from symofros.expr.graph import Graph
from symofros.mechanics.dynamics.bodies.inertia import link_inertias
from symofros.mechanics.kinematics.links import tree_kinematics
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.topology.tree import build_tree


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
