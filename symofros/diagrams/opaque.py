"""Blocks of Python's in a compiled run: what they hear, where their outputs go, when they are called."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from symofros.diagrams.block import Block
from symofros.diagrams.compiled import Resolved, fuser
from symofros.diagrams.layout import Place
from symofros.diagrams.wiring import Wired, surroundings
from symofros.errors import Problem, SymofrosError
from symofros.runtime.kernel import Array


class Opaque:
    """The blocks of Python's of a diagram, by number.

    Args:
        resolved: The diagram.

    Attributes:
        names: Of the blocks.
    """

    def __init__(self, resolved: Resolved) -> None:
        self._resolved = resolved
        self._writer = fuser(resolved)
        self.names = list(dict.fromkeys(name for due in resolved.schedule.sets for name in self.due(due)))

    def due(self, due: frozenset[str]) -> list[str]:
        """Those of a set, in the order in which they are called."""
        return self._writer.opaque(due)

    @property
    def blocks(self) -> list[Block]:
        """The blocks."""
        return [self._resolved.wired.blocks[name] for name in self.names]

    def places(self) -> list[list[Place]]:
        """Where the outputs of each lie in u."""
        ports = self._resolved.wired.ports
        return [[self._resolved.layout.held[name, port.name] for port in ports[name].outputs] for name in self.names]

    def lengths(self) -> list[int]:
        """How many numbers each hears."""
        wired = self._resolved.wired
        return [
            sum(math.prod(port.shape or ()) for port in wired.ports[name].inputs if (name, port.name) in wired.sources)
            for name in self.names
        ]

    def call(self, which: int, t: float, heard: Array) -> Array:
        """Call one; its outputs one after the other.

        Raises:
            SymofrosError: It returned what its ports do not promise.
        """
        name, wired = self.names[which], self._resolved.wired
        inputs, at = {}, 0
        for port in wired.ports[name].inputs:
            shape = port.shape or ()
            if (name, port.name) in wired.sources:
                inputs[port.name] = heard[at : at + math.prod(shape)].reshape(shape)
                at += math.prod(shape)
            else:
                inputs[port.name] = np.broadcast_to(np.asarray(port.default, dtype=np.float64), shape)
        found = wired.blocks[name].call(t, inputs)
        return np.concatenate([np.zeros(0), *(_output(name, found, port.name, port.shape or ())
                                              for port in wired.ports[name].outputs)])  # fmt: skip


def _output(name: str, found: Mapping[str, object], port: str, shape: tuple[int, ...]) -> Array:
    value = np.asarray(found.get(port, np.nan), dtype=np.float64)
    if port not in found or value.shape != shape:
        raise SymofrosError(str(Problem(f"block '{name}': output '{port}' does not fit",
                                        f"{value.shape}" if port in found else "nothing", f"{shape}",
                                        "return it so from call")))  # fmt: skip
    return value.reshape(-1)


@contextmanager
def begun(blocks: Iterable[Block], wired: Wired) -> Iterator[list[Block]]:
    """Blocks that know their models and have begun; each of them ends, however the run does."""
    opened: list[Block] = []
    try:
        for block in blocks:
            block.learn(surroundings(wired, block.name))
            block.begin()
            opened.append(block)
        yield opened
    finally:
        for block in opened:
            block.end()


def kept_by(blocks: Iterable[Block]) -> dict[str, dict[str, Array]]:
    """What each block kept of a run, those left out that keep nothing."""
    return {block.name: dict(found) for block in blocks if (found := block.kept())}
