"""Which kinds of blocks files can state: those that `symofros.blocks` exports, by their class names in snake case."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import symofros.blocks
from symofros.diagrams.block import Block

_WORD = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")

Kinds = Mapping[str, type[Block]]


def kind_of(block: type[Block]) -> str:
    """What a class of blocks is called in files: JointPD is joint_pd, View3D view3d."""
    return _WORD.sub("_", block.__name__).lower()


def kinds(extra: Iterable[type[Block]] = ()) -> dict[str, type[Block]]:
    """Kind -> class.

    Args:
        extra: Classes of the caller's own; one that is called as another takes its place.
    """
    exported = [vars(symofros.blocks)[name] for name in sorted(vars(symofros.blocks))]
    library = [item for item in exported if isinstance(item, type) and issubclass(item, Block) and item is not Block]
    return {kind_of(block): block for block in (*library, *extra)}
