"""A rigid description as a neutral tree, the form that engines of the matrix take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..contract.interface import Subject
from ..engines.interface import ORIGIN, Joint, Link, Tree, rows, vector
from ..mechanics.assembly import BASE, Assembly, Mover
from ..mechanics.joint_kinds import PartKind
from .reach import armature

# Simple joints of a description -> kinds of the matrix.
KINDS: dict[PartKind, str] = {
    "revolute": "revolute",
    "prismatic": "prismatic",
    "screw": "helical",
    "ball": "ball",
    "free": "free",
}


@dataclass(frozen=True)
class Stated:
    """A description as it is stated to an engine.

    Attributes:
        tree: The tree.
        movers: For each link of a joint, in order, the simple joints of the description that it hangs on.
        frames: Links of the subject's frames, without mass, fixed to those that carry them.
    """

    tree: Tree
    movers: tuple[tuple[Mover, ...], ...]
    frames: tuple[int, ...]

    @property
    def joints(self) -> list[int]:
        """Link after the last part of each joint of the description."""
        first = [group[0] for group in self.movers]
        return [k for k in range(len(first)) if k + 1 == len(first) or not first[k + 1].continues]


def stated(subject: Subject, whole: bool, merged: bool, splits_free: bool = True) -> Stated:
    """State a rigid description.

    Args:
        subject: The subject, all of whose joints are of KINDS.
        whole: Whether a link hangs on all parts of its joint, and a free joint of the base stands in the world; else
            each part has a link of its own.
        splits_free: Whether, in a whole joint, a free joint that is not of the base is stated as slides and a ball.
        merged: Whether all that is fixed to a link is one mass with it, by the harness's parallel axes; else each mass
            is a link that is fixed to it.
    """
    assembly = subject.assembly
    links: list[Link] = []
    groups: list[tuple[Mover, ...]] = []
    carriers: list[int] = [-1]  # The world, then for each mover the link that it carries.
    for k, mover in enumerate(assembly.movers):
        ends = k + 1 == len(assembly.movers) or not assembly.movers[k + 1].continues
        groups.append((*groups.pop(), mover) if whole and mover.continues else (mover,))
        carriers.append(len(links))
        if ends or not whole:
            joints = tuple(joint for one in groups[-1] for joint in _joints(subject, one, whole, splits_free))
            links.append(_massless(mover.body if ends else mover.name, carriers[groups[-1][0].parent - BASE], joints))
    links += _masses(assembly, links, carriers, merged)
    first = len(links)
    for name in subject.frames:
        site = assembly.frames[name]
        place = Joint("fixed", rows(site.X_BF.R), vector(site.X_BF.p))
        links.append(_massless(f"frame {name}", carriers[site.mover - BASE], (place,)))
    tree = Tree(assembly.name, tuple(links), vector(assembly.gravity))
    return Stated(tree, tuple(groups), tuple(range(first, len(links))))


def _massless(name: str, parent: int, joints: tuple[Joint, ...]) -> Link:
    return Link(name, parent, joints, 0.0, ORIGIN, ((0.0, 0.0, 0.0),) * 3)


def _masses(assembly: Assembly, links: list[Link], carriers: Sequence[int], merged: bool) -> list[Link]:
    """Give links the masses that stand for them; what has several, as links that are fixed to it."""
    fixed = []
    for mover, carrier in zip(assembly.movers, carriers[1:], strict=True):
        masses = [mover.merged()] if merged and mover.masses else mover.masses
        for one in masses:
            mass = one.mass, vector(one.p_BC), rows(one.J_BC)
            if len(masses) == 1:
                bare = links[carrier]
                links[carrier] = Link(bare.name, bare.parent, bare.joints, *mass)
            else:
                fixed.append(Link(f"mass of {one.body}", carrier, (Joint("fixed"),), *mass))
    return fixed


def _joints(subject: Subject, mover: Mover, whole: bool, splits_free: bool) -> tuple[Joint, ...]:
    """A simple joint in the vocabulary of the matrix."""
    inertia, speeds = armature(subject.system, mover), mover.part.speeds
    placed: dict[str, Any] = {"R": rows(mover.X_AP.R), "p": vector(mover.X_AP.p)}
    more: dict[str, Any] = {"armature": (inertia,) * speeds} if inertia else {}
    if mover.kind == "free" and whole and mover.parent == BASE:
        return (Joint("free", **more),)
    if mover.kind == "free" and whole and splits_free:
        return Joint("translation", **placed), Joint("ball")
    if speeds == 1:
        more["axis"] = vector(mover.axis)
    if mover.kind == "screw":
        more["pitch"] = mover.pitch
    return (Joint(KINDS[mover.kind], **placed, **more),)
