"""Which kinds of blocks files can state: those that `symofros.blocks` exports, by their class names in snake case."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import symofros.blocks
from symofros.base.arguments import check_argument
from symofros.diagrams.block import Block

_WORD = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")

# Entries of every block; a field of that name is stated with an underscore behind it.
KIND, INPUTS = "kind", "inputs"


def kind_of(block: type[Block]) -> str:
    """Name of a block class in files: JointPD is joint_pd, View3D view3d."""
    return _WORD.sub("_", block.__name__).lower()


def entry_of(name: str) -> str:
    """The entry of a file that states a field: its name, or kind_ and inputs_, where the file needs these itself."""
    return f"{name}_" if name in (KIND, INPUTS) else name


def kinds(extra: Iterable[type[Block]] = ()) -> dict[str, type[Block]]:
    """Kind -> class.

    Args:
        extra: Classes of the caller's own; one that is called as another takes its place.
    """
    extra = list(extra)
    check_argument("blocks", extra, Sequence[type[Block]])
    exported = [vars(symofros.blocks)[name] for name in sorted(vars(symofros.blocks))]
    library = [item for item in exported if isinstance(item, type) and issubclass(item, Block) and item is not Block]
    return {kind_of(block): block for block in (*library, *extra)}
