"""Blocks of Python's in a run: begun before it, called at instants, ended after it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.block import Port
from symofros.diagrams.external_block import ExternalBlock, Running
from symofros.diagrams.program.compiled import Resolved, fuser
from symofros.diagrams.program.layout import Place
from symofros.diagrams.wiring import Wired, surroundings
from symofros.errors import SymofrosError
from symofros.simulation.user_functions import named_function

# Calls whose outputs are kept for the parts of a run that are made once more.
_KEPT_CALLS = 100_000


class Called:
    """The blocks of Python's of a diagram in one run.

    Args:
        wired: The diagram.
        running: Block -> what it holds in this run.

    Attributes:
        given: Outputs of the first calls, by block and time.
    """

    def __init__(self, wired: Wired, running: Mapping[str, Running]) -> None:
        self._wired, self._running = wired, running
        self.given: dict[tuple[str, float], dict[str, Array]] = {}

    def call(self, name: str, t: float, inputs: Mapping[str, Array]) -> dict[str, Array]:
        """Call one.

        Args:
            name: Name of the block.
            t: Time [s].
            inputs: Signals of the connected inputs by port, which the block may keep.

        Returns:
            Output -> its signal, in the order of the ports.

        Raises:
            SymofrosError: It returned what its ports do not promise.
        """
        ports = self._wired.ports[name]
        signals = {
            port.name: inputs[port.name]
            if port.name in inputs
            else np.broadcast_to(np.asarray(port.default, dtype=np.float64), port.shape or ())
            for port in ports.inputs
        }
        stated = self._running[name].call(t, signals)
        outputs = {port.name: _output(name, stated, port.name, port.shape or ()) for port in ports.outputs}
        if len(self.given) < _KEPT_CALLS:
            self.given[name, t] = {port: value.copy() for port, value in outputs.items()}
        return outputs

    def ports(self, name: str) -> tuple[Port, ...]:
        """Outputs of a block, in order."""
        return tuple(self._wired.ports[name].outputs)

    def code(self, name: str) -> str:
        """The function that a block calls, with its file and line."""
        return named_function(getattr(self._wired.blocks[name], "function", None) or self._running[name].call)

    def kept(self) -> dict[str, dict[str, Array]]:
        """Block -> what it stored during the run; blocks that store nothing are left out."""
        return {name: dict(kept) for name, one in self._running.items() if (kept := one.kept())}


class NotKeptError(Exception):
    """The outputs of a call are not kept."""


class CalledBefore(Called):
    """The blocks of Python's as they answered in a run: none of them is called again.

    Args:
        wired: The diagram.
        given: Outputs by block and time.
    """

    def __init__(self, wired: Wired, given: dict[tuple[str, float], dict[str, Array]]) -> None:
        super().__init__(wired, {})
        self.given = given

    def call(self, name: str, t: float, inputs: Mapping[str, Array]) -> dict[str, Array]:
        """Outputs of the block at this time in the earlier run.

        Raises:
            NotKeptError: They were not stored.
        """
        if (name, t) not in self.given:
            raise NotKeptError
        return self.given[name, t]


def _output(name: str, outputs: Mapping[str, object], port: str, shape: tuple[int, ...]) -> Array:
    value = np.asarray(outputs.get(port, np.nan), dtype=np.float64)
    if port not in outputs or value.shape != shape:
        raise SymofrosError(
            f"block '{name}': output '{port}' does not fit",
            f"{value.shape}" if port in outputs else "nothing",
            f"{shape}",
            "return it so from call",
        )
    return value


@contextmanager
def begun(wired: Wired) -> Iterator[Called]:
    """The blocks of Python's, begun for one run; each that has begun ends, however the run does."""
    running: dict[str, Running] = {}
    with ExitStack() as ends:
        for name, block in wired.blocks.items():
            if isinstance(block, ExternalBlock):
                running[name] = block.begin(surroundings(wired, name))
                ends.callback(running[name].end)
        yield Called(wired, running)


class ExternalCalls:
    """Calls of the external blocks of a compiled run, by number, with inputs and outputs as vectors.

    Args:
        resolved: The diagram.
        called: Python blocks of this run.

    Attributes:
        names: Names of the blocks.
        output_places: Places in u of each block's outputs.
        input_sizes: Length of each block's vector of inputs.
    """

    def __init__(self, resolved: Resolved, called: Called) -> None:
        self._called = called
        self._writer = fuser(resolved)
        self.names = list(dict.fromkeys(name for due in resolved.schedule.sets for name in self.due(due)))
        wired = resolved.wired
        self._input_ports = [
            [(port.name, port.shape or ()) for port in wired.ports[name].inputs if (name, port.name) in wired.sources]
            for name in self.names
        ]
        self.input_sizes = [sum(math.prod(shape) for _, shape in ports) for ports in self._input_ports]
        self.output_places: list[list[Place]] = [
            [resolved.layout.held[name, port.name] for port in wired.ports[name].outputs] for name in self.names
        ]

    def due(self, due: frozenset[str]) -> list[str]:
        """External blocks of a set, in the order in which they are called."""
        return self._writer.external(due)

    def call(self, which: int, t: float, gathered: Array) -> Array:
        """Call a block with its inputs, one after the other; outputs lie one after the other, too.

        Raises:
            SymofrosError: It returned what its ports do not promise.
        """
        inputs, at = {}, 0
        for port, shape in self._input_ports[which]:
            inputs[port] = gathered[at : at + math.prod(shape)].reshape(shape)
            at += math.prod(shape)
        outputs = self._called.call(self.names[which], t, inputs)
        return np.concatenate([np.zeros(0), *(value.reshape(-1) for value in outputs.values())])

    def fault(self, which: int, t: float, outputs: Array) -> str:
        """Message that names the first output of a block that is not finite; outputs as `call` returns them."""
        name, at = self.names[which], 0
        for port in self._called.ports(name):
            size = math.prod(port.shape or ())
            bad = outputs[at : at + size][~np.isfinite(outputs[at : at + size])]
            if len(bad):
                return (
                    f"block '{name}': output '{port.name}' is {bad[0]} at t = {t:.6g} s, by {self._called.code(name)}"
                )
            at += size
        return ""
