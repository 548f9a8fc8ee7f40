"""Loops that are closed with all coordinates zero, whose numbers are as short as their placements'."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..interface import (
    IDENTITY,
    ORIGIN,
    Array,
    Constraint,
    End,
    Joint,
    Link,
    Tree,
    Vector,
    rows,
    vector,
)
from .pieces import Piece, Pieces

_UNITS: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def at_zero(tree: Tree, pieces: Pieces) -> Iterator[tuple[Tree, Pieces]]:
    """The tree, and plainer ones, closed with all coordinates zero: at rest, and as they move."""
    zero = tuple(tuple(_zero(piece) for piece in own) for own in pieces)
    still = tuple(tuple(replace(piece, v=(0.0,) * len(piece.v)) for piece in own) for own in zero)
    for variant in _plainer(tree):
        for state in (still, zero):
            yield _fitted(variant), state


def _plainer(tree: Tree) -> Iterator[Tree]:
    """Trees whose links stand along the axes, whose shorter branches are left, and the tree itself."""
    for shorter in (*_shortened(tree), tree):
        for turn in (0, 1, 2):
            for plain in (True, False):
                yield replace(
                    shorter, links=tuple(_aligned(k, turn, plain, one) for k, one in enumerate(shorter.links))
                )
    yield tree


def _aligned(k: int, turn: int, plain: bool, link: Link) -> Link:
    joints = tuple(_joint(joint, k, turn) for joint in link.joints)
    link = replace(link, joints=joints)
    return replace(link, mass=1.0, com=ORIGIN, inertia=IDENTITY) if plain else link


def _joint(joint: Joint, k: int, turn: int) -> Joint:
    moved = replace(joint, R=IDENTITY, p=_UNITS[(k + turn) % 3])
    return replace(moved, axis=_UNITS[k % 3]) if joint.kind in ("revolute", "prismatic") else moved


def _shortened(tree: Tree) -> Iterator[Tree]:
    """The tree with a constraint's end on its link's parent; the link goes with the next step of the shrinking."""
    names = {link.name: link for link in tree.links}
    for number, one in enumerate(tree.constraints):
        for place, end in enumerate(one.ends):
            parent = names[end.link].parent if end.link else -1
            if parent >= 0 and one.kind != "coupling":
                moved = end._replace(link=tree.links[parent].name)
                ends = (*one.ends[:place], moved, *one.ends[place + 1 :])
                if len({each.link for each in ends}) == len(ends):
                    changed = (*tree.constraints[:number], replace(one, ends=ends), *tree.constraints[number + 1 :])
                    yield replace(tree, constraints=changed)


def _zero(piece: Piece) -> Piece:
    """A joint at the coordinates that mean no motion."""
    q = [0.0] * len(piece.q)
    if "quaternion first" in piece.chart:
        q[0] = 1.0
    elif "wxyz" in piece.chart:
        q[-4] = 1.0
    elif "cos sin" in piece.chart:
        q[-2] = 1.0
    elif "xyzw" in piece.chart:
        q[-1] = 1.0
    return replace(piece, q=tuple(q), q2=tuple(q))


def _fitted(tree: Tree) -> Tree:
    """The tree whose points and welds meet with all coordinates zero: their second ends are placed at the first."""
    poses: dict[str, tuple[Array, Array]] = {"": (np.eye(3), np.zeros(3))}
    for link in tree.links:
        R, p = poses[tree.links[link.parent].name if link.parent >= 0 else ""]
        for joint in link.joints:
            R, p = R @ np.array(joint.R), p + R @ np.array(joint.p)
        poses[link.name] = (R, p)

    def meeting(one: Constraint) -> Constraint:
        if one.kind not in ("point", "weld"):
            return one
        (R1, p1), (R2, p2) = (poses[end.link] for end in one.ends)
        second = End(one.ends[1].link, rows(R2.T @ R1), vector(R2.T @ (p1 - p2)))
        return replace(one, ends=(End(one.ends[0].link), second))

    return replace(tree, constraints=tuple(map(meeting, tree.constraints)))
