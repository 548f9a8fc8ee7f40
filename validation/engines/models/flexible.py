"""Flexible bodies: no tree states them, so that engines are asked for relations between two of their own models.

A name says of what (solid, shell, cable), and what is compared (forces, a step) where the frame that the body stands in
is turned or shifted; or that the sum or the moment of internal forces is asked, which is nothing.
"""

from __future__ import annotations

from ..interface import Joint, Link, Tree

BODIES = ("solid", "shell that bends", "shell that stretches", "cable")
RELATIONS = (
    "forces in a turned frame",
    "step in a turned frame",
    "implicit step in a turned frame",
    "forces in a shifted frame",
    "sum of forces",
    "moment of forces",
)


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    names = [f"flexible {body}: {relation}" for body in BODIES for relation in RELATIONS]
    base = Link("p", -1, (Joint("fixed"),))
    return {name: Tree(name, (base,), asked="flexible bodies") for name in names}
