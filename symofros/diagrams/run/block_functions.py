"""Every block of a diagram as functions on memory of its own, which Python calls one by one."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved, bare_record, unit_of
from symofros.diagrams.program.lowered_block import INPUT, MEMORY, PARAMETER, STATE, Piece
from symofros.diagrams.program.model_environment import parameter_group
from symofros.diagrams.run.python_blocks import Called
from symofros.diagrams.run.starts import Start, close_loops
from symofros.diagrams.wiring import Source
from symofros.expr import Function, Output, Program
from symofros.generator import run_passes
from symofros.runtime.build import Toolchain
from symofros.runtime.calls import Kernel
from symofros.runtime.constrained import constrained
from symofros.simulation.inputs import held_sample

Call = Callable[[], None]


class Blocks:
    """Every block of a diagram as functions on memory of its own.

    Args:
        resolved: The diagram.
        par: Run-time parameters (npar).
        gains: Baumgarte's, one pair for all conditions.
        toolchain: Compiles each block by itself; None: NumPy interprets it.

    Attributes:
        par: Run-time parameters (npar).
        step_end: Where the step under way ends [s]: held samples that begin there do not count yet; inf between steps.
    """

    def __init__(self, resolved: Resolved, par: Array, gains: tuple[float, float], toolchain: Toolchain | None) -> None:
        self.resolved = resolved
        self.par, self._gains, self._toolchain = par, gains, toolchain
        layout = resolved.layout
        self.t, self.step_end = np.zeros(1), math.inf
        self.q, self.v = np.array(layout.q0, dtype=np.float64), np.array(layout.v0, dtype=np.float64)
        self.a, self.lam = np.zeros(len(self.v)), np.zeros(len(layout.condition_names))
        self.memory = {key: resolved.pieces[key[0]].memory[key[1]].copy() for key in layout.memory}
        self.out = {source: np.zeros(resolved.wired.shape(source)) for source in resolved.order}
        self.calls: dict[tuple[str, str], tuple[Call, dict[str, Array]]] = {}
        self._bound: list[tuple[Kernel, Array, list[Array]]] = []  # What calls have addresses of.
        for piece in resolved.pieces.values():
            self._make(piece)

    def close_loops(self) -> tuple[str, ...]:
        """Bring the first state onto the constraints; says what of a stated start changed in its last digits.

        Raises:
            AssemblyError: No state on the constraints keeps what is stated.
        """
        begin = Start(float(self.t[0]), self.q, self.v, np.zeros(0))
        return close_loops(self.resolved, self.resolved.layout.whole, begin, self.par)

    def _make(self, piece: Piece) -> None:
        """The functions of one block: each output, rates, updates, the terms of its motion."""
        name = piece.name
        stated: dict[str, dict[str, Any]] = {f"out_{port}": {"y": value} for port, value in piece.outputs.items()}
        stated["rates"] = {f"d_{key}": value for key, value in piece.rates.items()}
        stated["updates"] = {f"n_{key}": value for key, value in piece.updates.items()}
        stated["motion"] = {f"t_{key}": value for key, value in piece.terms.stated().items()}
        stated["begins"] = {f"n_{key}": value for key, value in piece.begins.items()}
        stated["crossings"] = {f"c_{key}": crossing.value for key, crossing in piece.crossings.items()}
        for which, jump in piece.jumps.items():
            stated[f"crossed_{which}"] = {f"n_{key}": value for key, value in jump.items()}
        functions, sizes = [], {"par": 0}
        for which, outputs in stated.items():
            if outputs:
                edges = [edge for value in outputs.values() for edge in value.flat]
                groups = piece.groups(edges)
                sizes |= {group: self._memory_of(piece, group).size for group in groups}
                made = tuple(Output(key, value.shape, tuple(value.flat)) for key, value in outputs.items())
                functions.append(Function(which, "", groups, made))
        if not functions:
            return
        program = run_passes(Program(name, piece.g, sizes, tuple(functions)))
        unit, _ = unit_of(program, bare_record(name), self._toolchain)
        for function in functions:
            kernel = unit.kernels[function.name, ""]
            inputs = [self._memory_of(piece, group) for group in function.inputs]
            port = function.name.removeprefix("out_")
            returned = {key: self.out[name, port] if key == "y" else np.zeros(shape) for key, shape in function.returns}
            pre = kernel.prepare(np.zeros((1, 0)))
            self._bound.append((kernel, pre, inputs))
            self.calls[name, function.name] = kernel.bind(pre, inputs, list(returned.values())), returned

    def _memory_of(self, piece: Piece, group: str) -> Array:
        """The array that an input group of a block is read from, flat."""
        name, layout, wired = piece.name, self.resolved.layout, self.resolved.wired
        if group == "t":
            return self.t
        if group in ("q", "v", "a"):
            places = layout.q if group == "q" else layout.v
            array: Array = getattr(self, group)[places[name].slice]
            return array
        if group == "lam":
            return self.lam[layout.lam[name].slice]
        if group == "gains":
            return np.repeat(np.array(self._gains), piece.nc)
        if group.startswith(INPUT):
            return self.out[wired.sources[name, group.removeprefix(INPUT)]].reshape(-1)
        if group.startswith(STATE):
            return self.v[layout.states[name, group.removeprefix(STATE)].slice]
        if group.startswith(MEMORY):
            return self.memory[name, group.removeprefix(MEMORY)].reshape(-1)
        if group.startswith(PARAMETER):
            return self.par[layout.parameters[name, group.removeprefix(PARAMETER)].slice]
        model = next(model for model in wired.models.names if parameter_group(model) == group)
        mine = piece.block.mechanism() == model
        return layout.parameters_of(name, model, self.par) if mine else self.par[layout.parameters["", model].slice]

    def signals(self, due: frozenset[str] = frozenset(), called: Called | None = None) -> None:
        """Continuous outputs at the present point, in order; those of sampled blocks that are due, too.

        Python is called once a block: at its first output, all of which need all inputs; without outputs, at the end.

        Args:
            due: Blocks that are sampled.
            called: The blocks of Python's; None where none is due.
        """
        waiting = {name for name in due if called and self.resolved.pieces[name].is_external}
        for source in self.resolved.order:
            name, port = source
            piece = self.resolved.pieces[name]
            block = piece.block
            if port in block.samples():
                self._sample(source)
            elif called and name in waiting:
                waiting.remove(name)
                self._call_python(called, name)
            elif not piece.is_external and (name in due or not piece.is_discrete):
                self.calls[name, f"out_{port}"][0]()
        for name in self.resolved.pieces:
            if called and name in waiting:
                self._call_python(called, name)

    def _sample(self, source: Source) -> None:
        signal = self.resolved.pieces[source[0]].block.samples()[source[1]]
        columns = signal.values.reshape(len(signal.t), -1).T
        t = float(self.t[0])
        if signal.kind == "linear":
            samples = [np.interp(t, signal.t, column) for column in columns]
        else:
            samples = columns[:, held_sample(signal.t, t, self.step_end)]
        self.out[source].reshape(-1)[:] = samples

    def _call_python(self, called: Called, name: str) -> None:
        sources = self.resolved.wired.sources
        inputs = {
            port: self.memory.get((name, port), self.out[source]).copy()
            for (block, port), source in sources.items()
            if block == name
        }
        for key, value in called.call(name, float(self.t[0]), inputs).items():
            self.out[name, key][...] = value

    def engaged(self) -> Array:
        """Values of the lock inputs of all blocks, which state which constraints are engaged."""
        wired = self.resolved.wired
        ports = [(name, port) for name, piece in self.resolved.pieces.items() for port in piece.block.lock_inputs()]
        return np.concatenate([np.zeros(0), *(self.out[wired.sources[port]].reshape(-1) for port in ports)])

    def update(self, due: frozenset[str]) -> None:
        """Memory of the sampled blocks that are due."""
        self._change([(name, "updates") for name in sorted(due)])

    def begin(self) -> None:
        """Memory that begins by what signals are."""
        self._change([(name, "begins") for name in self.resolved.pieces])

    def cross(self, name: str, which: str) -> None:
        """What a crossing changes: memory, states, the motion of a mechanism."""
        self._change([(name, f"crossed_{which}")])

    def crossing_values(self, values: Array) -> None:
        """Values of all crossings (n) at the present point, whose signals are known."""
        i = 0
        for name, piece in self.resolved.pieces.items():
            if piece.crossings:
                call, outputs = self.calls[name, "crossings"]
                call()
                for which in piece.crossings:
                    values[i], i = outputs[f"c_{which}"], i + 1

    def _change(self, functions: list[tuple[str, str]]) -> None:
        """Memory and states as functions of blocks have them next, all of the values before."""
        new = []
        for name, function in functions:
            if (name, function) in self.calls:
                call, outputs = self.calls[name, function]
                call()
                new += [(self._place_of(name, key.removeprefix("n_")), value.copy()) for key, value in outputs.items()]
        for place, value in new:
            place[...] = value.reshape(place.shape)

    def _place_of(self, name: str, key: str) -> Array:
        """What holds a memory or a state of a block, or the motion of its mechanism."""
        layout = self.resolved.layout
        if (name, key) in self.memory:
            return self.memory[name, key]
        if (name, key) in layout.states:
            return self.v[layout.states[name, key].slice]
        return self.q[layout.q[name].slice] if key == "q" else self.v[layout.v[name].slice]

    def accelerate(self) -> None:
        """The accelerations a and multipliers of all mechanisms, and rates of states, at the present point."""
        layout = self.resolved.layout
        for name in layout.v:
            call, outputs = self.calls[name, "motion"]
            call()
            if "t_a" in outputs:
                self.a[layout.v[name].slice] = outputs["t_a"]
            else:
                M, r, G, c = (outputs[f"t_{key}"][np.newaxis] for key in ("M", "r", "G", "c"))
                a, lam, _ = constrained(M, r, G, c, layout.measures[name])
                self.a[layout.v[name].slice], self.lam[layout.lam[name].slice] = a[0], lam[0]
        for (name, key), place in layout.states.items():
            if place.size:
                call, outputs = self.calls[name, "rates"]
                call()
                self.a[place.slice] = outputs[f"d_{key}"].reshape(-1)
