"""The states that each function is asked at, on one model object: ordinary, zero, fast, others, the first again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .interface import HasLayout, State, Tree
from .truth.constraints import closed
from .truth.dynamics import neutral, random_state

# How much faster the fast state is than the first.
FAST = 100.0
# Names of states, as words say them; the first has none.
ZERO, SWIFT, SECOND, AGAIN, AMONG = "at zero", "at speeds times 100", "at a second state", "at the first again", "among"
_RESTARTS = 5


class Visit(NamedTuple):
    """A state, by its name in words; of those `AMONG` many only what is no number counts."""

    name: str
    state: State


def visits(tree: Tree, layout: HasLayout, first: State, seed: int, many: int) -> Iterator[Visit]:
    """The states after the first, in the order in which they are asked.

    Args:
        tree: The tree.
        layout: How the engine keeps its joints.
        first: The first state; constraints hold there.
        seed: Its seed.
        many: Number of random states, the last of which is the second state; of trees with constraints there is that
            one alone.
    """
    nothing = np.zeros(layout.nv)
    # Where constraints hold, the coordinates stay: zero need not be among theirs.
    q = first.q if tree.constraints else neutral(layout)
    yield Visit(ZERO, replace(first, q=q, q2=q, v=nothing, v2=nothing))
    yield Visit(SWIFT, replace(first, v=FAST * first.v))
    for number in range(1, (1 if tree.constraints else many) + 1):
        drawn = random_state(tree, layout, seed + number)
        state = closed(tree, layout, drawn, _RESTARTS) if tree.constraints else drawn
        if isinstance(state, State):
            yield Visit(AMONG if number < many and not tree.constraints else SECOND, state)
    yield Visit(AGAIN, first)
