"""Flexible bodies: no tree states them, so that engines are asked for relations between two of their own models.

A name says of what (solid, shell, cable), what is compared (forces, a step) and what is changed: the frame that the body
stands in is turned or shifted, or nothing is, and the sum of internal forces, or what a rigid motion makes of them, is asked.
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
