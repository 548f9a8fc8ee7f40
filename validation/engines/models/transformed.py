"""Trees that an engine transforms once it has built them: joints locked, models attached, links fused, changes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..interface import ORIGIN, Joint, Link, Rows, Tree
from .hostile import trees as hostile_trees
from .kinds import OBLIQUE, link, placed, turned
from .readers import diagonal, in_series


def _hinge(draw: np.random.Generator, **changes: float) -> Joint:
    return replace(placed(draw, Joint("revolute", axis=OBLIQUE)), **changes)  # type: ignore[arg-type]


def _massless(tree: Tree) -> Tree:
    """The tree with no mass in its first link."""
    first = replace(tree.links[0], mass=0.0, com=ORIGIN, inertia=(ORIGIN, ORIGIN, ORIGIN))
    return replace(tree, links=(first, *tree.links[1:]))


def _locked(name: str, *joints: Joint, base: bool = False) -> Tree:
    draw = np.random.default_rng([ord(letter) for letter in name])
    links: list[Link] = [link(draw, "base", -1, Joint("free"))] if base else []
    for k, joint in enumerate(joints):
        links.append(link(draw, "abcdef"[k], len(links) - 1, placed(draw, joint)))
    return Tree(name, tuple(links))


def _fused_at_one_point(name: str, *turn: Rows) -> Tree:
    """Fixed links whose origins and mass centres are one point, with principal inertias that one turn lies between."""
    draw = np.random.default_rng(13)
    principal = diagonal(0.125, 0.1875, 0.25)
    first = Link("a", -1, (_hinge(draw),), 1.5, inertia=principal)
    held = Joint("fixed", R=turn[0] if turn else turned(draw))
    return Tree(name, (first, Link("b", 0, (held,), 0.75, inertia=principal)), fused=True)


def _fixed_parts() -> tuple[Link, ...]:
    """Links of which those of an attached model don't move in it, but for the last."""
    draw = np.random.default_rng(14)
    held = [_hinge(draw), _hinge(draw), *(placed(draw, Joint("fixed")) for _ in range(2)), _hinge(draw)]
    return tuple(link(draw, "abcde"[k], k - 1, joint) for k, joint in enumerate(held))


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    free, held = Joint("revolute", axis=OBLIQUE), Joint("revolute", axis=OBLIQUE, locked=0.75)
    slide = Joint("prismatic", axis=OBLIQUE, locked=-0.5)
    draw = np.random.default_rng(8)
    parts = tuple(link(draw, "abcde"[k], parent, _hinge(draw)) for k, parent in enumerate((-1, 0, 1, 2, 2)))
    made = (
        _locked("locked hinge amid", free, held, free),
        _locked("locked slide at the end", free, free, slide),
        # Not all engines count the mass of what stands still.
        _massless(_locked("locked hinge first", held, free, free)),
        _locked("locked hinge and slide in series", free, held, slide, free),
        _locked("locked hinge on a free base", held, free, base=True),
        Tree("attached chain", parts[:4], attached="c"),
        Tree("attached branches", parts, attached="c"),
        Tree("attached fixed links", _fixed_parts(), attached="c"),
        replace(hostile_trees()["fixed links amid"], name="fixed links fused", fused=True),
        _fused_at_one_point("fixed links fused at one point"),
        _fused_at_one_point("fixed links fused at a quarter turn", in_series(("z", math.pi / 2.0))),
    )
    changed = tuple(
        Tree(f"{what} changed", parts[:2], changed=what) for what in ("mass", "inertia", "frame", "gravity")
    )
    return {tree.name: tree for tree in (*made, *changed)}
