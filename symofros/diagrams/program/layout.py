"""Where everything of a diagram lies in its vectors q, v, u and par.

A diagram moves as one mechanism does: each continuous state s is a speed whose rate is s', beside an idle coordinate;
what is held between samples, and what samples over time give, are inputs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import prod
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array, Mask
from symofros.base.measures import Measures
from symofros.base.names import speed_column
from symofros.diagrams.block import Shape
from symofros.diagrams.inlets import Inlet
from symofros.diagrams.program.lowered_block import Piece
from symofros.diagrams.wiring import Source, Wired
from symofros.errors import DescriptionError, UnknownNameError, did_you_mean
from symofros.runtime.record import Segment
from symofros.simulation.inputs import Signal


class Place(NamedTuple):
    """A run of entries."""

    start: int
    shape: Shape

    @property
    def size(self) -> int:
        """Number of entries."""
        return prod(self.shape)

    @property
    def slice(self) -> slice:
        """The entries."""
        return slice(self.start, self.start + self.size)

    @property
    def range(self) -> range:
        """Their indices."""
        return range(self.start, self.start + self.size)


class Kept(NamedTuple):
    """Run-time parameters that events of a block's mechanism change.

    Attributes:
        numbers: Theirs among those of its model.
        first: Their places among the diagram's parameters, which they begin with.
        par: Their places among the parameters of the part that moves it.
        memory: Where the diagram remembers them, among the inputs.
    """

    numbers: tuple[int, ...]
    first: tuple[int, ...]
    par: Place
    memory: Place


@dataclass(frozen=True)
class Part:
    """Mechanisms and states that move together between samples.

    Attributes:
        blocks: Blocks with continuous states.
        q: Range of its entries in the diagram's q.
        v: Range of its entries in the diagram's v.
        conditions: Range of its entries in the diagram's lam.
    """

    blocks: tuple[str, ...]
    q: slice
    v: slice
    conditions: slice

    @property
    def nq(self) -> int:
        """Number of coordinates."""
        return int(self.q.stop - self.q.start)

    @property
    def nv(self) -> int:
        """Number of speeds."""
        return int(self.v.stop - self.v.start)

    @property
    def nc(self) -> int:
        """Number of conditions."""
        return int(self.conditions.stop - self.conditions.start)


@dataclass
class Layout:
    """Places of everything.

    Attributes:
        parts: Parts in the order of q.
        q: Block -> its mechanism's configuration.
        v: Block -> its mechanism's speeds.
        lam: Block -> multipliers of its constraints.
        state_counts: Block -> number of states of its mechanism's forces, the last of its speeds.
        states: (block, state) -> the speeds that it is.
        held: (block, output) of sampled blocks -> inputs.
        memory: (block, memory) -> inputs.
        samples: (block, output) given over time -> inputs.
        parameters: (block, field), and ("", model) -> parameters.
        par: Their values.
        q0: First q, v and u.
        v0: First v.
        u0: First u.
        q_names: Names of q, v, u, par.
        v_names: Names of the speeds, as q_names.
        u_names: Names of the inputs, as q_names.
        par_names: Names of the run-time parameters, as q_names.
        segments: Segments of the configuration manifold.
        signals: (index in u, times, values, whether linear).
        lock_inputs: Entries of u that engage constraints: a change projects the state onto them.
        lock_names: Names of these, by block and port.
        condition_names: Names of the conditions of constraints.
        speed_conditions: Names of the conditions on speeds only.
        driven: Whether some mechanism has prescribed motions.
        measures: Block -> measures of its mechanism's constraint Jacobian.
        kept: Block -> parameters that events of its mechanism change; the last of par and of u.
        settable: Number of parameters that a run may be given.
    """

    parts: list[Part] = field(default_factory=list)
    q: dict[str, Place] = field(default_factory=dict)
    v: dict[str, Place] = field(default_factory=dict)
    lam: dict[str, Place] = field(default_factory=dict)
    state_counts: dict[str, int] = field(default_factory=dict)
    states: dict[tuple[str, str], Place] = field(default_factory=dict)
    held: dict[Source, Place] = field(default_factory=dict)
    memory: dict[tuple[str, str], Place] = field(default_factory=dict)
    samples: dict[Source, Place] = field(default_factory=dict)
    parameters: dict[tuple[str, str], Place] = field(default_factory=dict)
    par: list[float] = field(default_factory=list)
    q0: list[float] = field(default_factory=list)
    v0: list[float] = field(default_factory=list)
    u0: list[float] = field(default_factory=list)
    q_names: list[str] = field(default_factory=list)
    v_names: list[str] = field(default_factory=list)
    u_names: list[str] = field(default_factory=list)
    par_names: list[str] = field(default_factory=list)
    segments: list[Segment] = field(default_factory=list)
    signals: list[tuple[int, Array, Array, bool]] = field(default_factory=list)
    lock_inputs: list[int] = field(default_factory=list)
    lock_names: list[str] = field(default_factory=list)
    condition_names: list[str] = field(default_factory=list)
    speed_conditions: list[str] = field(default_factory=list)
    driven: bool = False
    measures: dict[str, Measures] = field(default_factory=dict)
    kept: dict[str, Kept] = field(default_factory=dict)
    settable: int = 0

    def begun(self, par: Array) -> Array:
        """First inputs (nu), with what events change as the run-time parameters (npar) have it."""
        u = np.array(self.u0, dtype=np.float64)
        for kept in self.kept.values():
            u[kept.memory.slice] = par[list(kept.first)]
        return u

    def present(self, par: Array, u: Array) -> Array:
        """Run-time parameters (..., npar) of parts where inputs and memory are u (..., nu)."""
        if not self.kept:
            return par
        now = np.array(np.broadcast_to(par, (*u.shape[:-1], par.shape[-1])))
        for kept in self.kept.values():
            now[..., kept.par.slice] = u[..., kept.memory.slice]
        return now

    @property
    def kept_rows(self) -> list[tuple[int, int, int, int]]:
        """Rows of sym_kept: part, parameter, input, parameter that it begins with."""
        return [
            (next(i for i, part in enumerate(self.parts) if block in part.blocks), par, memory, of)
            for block, kept in self.kept.items()
            for par, memory, of in zip(kept.par.range, kept.memory.range, kept.first, strict=True)
        ]

    def places_of(self, block: str, model: str) -> list[int]:
        """Where the parameters of the model that a block moves lie among those of its part."""
        places = list(self.parameters["", model].range)
        if block in self.kept:
            for i, place in zip(self.kept[block].numbers, self.kept[block].par.range, strict=True):
                places[i] = place
        return places

    def parameters_of(self, block: str, model: str, par: Array) -> Array:
        """Parameters (..., npar) of the model that a block moves, as `present` has those of its part."""
        return np.asarray(par[..., self.places_of(block, model)])

    def measures_of(self, part: Part) -> Measures:
        """Measures of the constraint Jacobian of a part."""
        blocks = (
            (self.lam[name].start - part.conditions.start, self.v[name].start - part.v.start, self.measures[name])
            for name in part.blocks
            if name in self.measures
        )
        return Measures.joined(blocks, part.nc, part.nv)

    @property
    def whole(self) -> Part:
        """All parts as one."""
        blocks = tuple(name for part in self.parts for name in part.blocks)
        sizes = (len(self.q0), len(self.v0), len(self.condition_names))
        return Part(blocks, *(slice(0, size) for size in sizes))

    @property
    def speed_labels(self) -> list[str]:
        """Names of speeds and states (nv) that differ from those of coordinates: "arm.dq1" of the rate of "arm.q1"."""
        labels = list(self.v_names)
        for block, place in self.v.items():
            own = [name.removeprefix(f"{block}.") for name in self.q_names[self.q[block].slice]]
            for i in place.range:
                labels[i] = f"{block}.{speed_column(labels[i].removeprefix(f'{block}.'), own)}"
        return labels

    def start_place(self, name: str) -> tuple[str, Place]:
        """Where a state begins: its vector, "q", "v" or "u", and its place there.

        Args:
            name: "block.q" or "block.v" of a mechanism as a whole, "block.state" or "block.memory" of another block, or
                one entry, such as "arm.q1", "arm.dq1" or "filter.s[0]".

        Raises:
            UnknownNameError: There is no such state.
        """
        block, _, key = name.rpartition(".")
        if block in self.q and key in ("q", "v"):
            return key, self.moved(block)[key == "v"]
        if (block, key) in self.states:
            return "v", self.states[block, key]
        if (block, key) in self.memory:
            return "u", self.memory[block, key]
        entries = {
            names[i]: (group, Place(i, ()))
            for group, names, places in (
                ("u", self.u_names, self.memory.values()),
                ("v", self.speed_labels, [*self.v.values(), *self.states.values()]),
                ("q", self.q_names, self.q.values()),
            )
            for place in places
            for i in place.range
        }
        if name in entries:
            return entries[name]
        what, rule = f"diagram: no state '{name}' that begins with a value", f"known: {', '.join(entries)}"
        remedy = did_you_mean(name, entries) or "symofros info lists states; outputs and parameters are none"
        raise UnknownNameError(what, f"'{name}'", rule[:400], remedy)

    @property
    def moving(self) -> Mask:
        """Whether each speed is one of a mechanism (nv), and no state of a force or a block."""
        moving = np.zeros(len(self.v0), dtype=bool)
        for block in self.v:
            moving[self.moved(block)[1].slice] = True
        return moving

    def moved(self, block: str) -> tuple[Place, Place]:
        """Places of configuration and speeds of the mechanism that a block moves.

        Raises:
            UnknownNameError: It moves none.
        """
        if block in self.q:
            q, v, of_forces = self.q[block], self.v[block], self.state_counts[block]
            return Place(q.start, (q.size - of_forces,)), Place(v.start, (v.size - of_forces,))
        known = ", ".join(self.q) or "none"
        what, remedy = f"block '{block}' moves no mechanism", did_you_mean(block, self.q) or "name a plant's"
        raise UnknownNameError(what, f"those that do: {known}", "motions are of mechanisms", remedy)


def lay_out(wired: Wired, pieces: Mapping[str, Piece], groups: Sequence[Sequence[str]]) -> Layout:
    """Place the states of each group together, then inputs and parameters."""
    layout = Layout()
    for names in groups:
        q, v, c = len(layout.q0), len(layout.v0), len(layout.condition_names)
        for name in names:
            _mechanism(layout, wired, pieces[name])
        for name in names:
            _states(layout, pieces[name])
        conditions = slice(c, len(layout.condition_names))
        layout.parts.append(Part(tuple(names), slice(q, len(layout.q0)), slice(v, len(layout.v0)), conditions))
    for name, piece in pieces.items():
        _inputs(layout, wired, name, piece)
        for key, values in piece.parameters.items():
            layout.parameters[name, key] = _placed(layout.par, layout.par_names, f"{name}.{key}", values)
    for name, piece in pieces.items():
        _locks(layout, wired, name, piece)
    for model in wired.models.names:
        names = wired.models.record(model).par_names
        layout.parameters["", model] = Place(len(layout.par), (len(names),))
        layout.par += wired.models.parameters(model).tolist()
        layout.par_names += [f"{model}.{name}" for name in names]
    layout.settable = len(layout.par)
    for piece in pieces.values():
        if piece.switching is not None:
            _keep(layout, wired, piece, piece.switching.kept)
    return layout


def _locks(layout: Layout, wired: Wired, name: str, piece: Piece) -> None:
    """Note where the signals are held that engage constraints."""
    for port in piece.block.lock_inputs():
        place = layout.held.get(wired.sources.get((name, port), ("", "")))
        if place is None:
            raise DescriptionError(
                f"block '{name}': input '{port}' is not held between samples",
                "a continuous signal",
                "constraints engage at samples",
                "put a hold with a period before it",
            )
        layout.lock_inputs += range(place.start, place.start + place.size)
        layout.lock_names += [f"{name}.{port}[{k}]" for k in range(place.size)]


def _keep(layout: Layout, wired: Wired, piece: Piece, index: tuple[int, ...]) -> None:
    """Place the parameters that events of a mechanism change, in the part and in the diagram's memory."""
    model = piece.block.mechanism()
    names = [f"{piece.name}.{wired.models.record(model).par_names[i]}" for i in index]
    values = wired.models.parameters(model)[list(index)].tolist()
    par, memory = Place(len(layout.par), (len(index),)), Place(len(layout.u0), (len(index),))
    first = layout.parameters["", model].start
    layout.kept[piece.name] = Kept(index, tuple(first + i for i in index), par, memory)
    layout.par += values
    layout.par_names += names
    layout.u0 += values
    layout.u_names += names


def _mechanism(layout: Layout, wired: Wired, piece: Piece) -> None:
    if not piece.block.mechanism():
        return
    name, record = piece.name, wired.models.carried(piece.block.mechanism())
    q, v = len(layout.q0), len(layout.v0)
    layout.q[name], layout.v[name] = Place(q, (len(piece.q),)), Place(v, (len(piece.v),))
    layout.lam[name] = Place(len(layout.condition_names), (piece.nc,))
    layout.state_counts[name] = len(record.state_names)
    layout.measures[name] = record.measures
    layout.driven |= record.driven > 0
    layout.segments += [Segment(s.kind, s.q + q, s.v + v, s.size) for s in record.segments]
    layout.q0 += piece.q.tolist()
    layout.v0 += piece.v.tolist()
    layout.q_names += [f"{name}.{item}" for item in record.q_names]
    layout.v_names += [f"{name}.{item}" for item in record.v_names]
    layout.condition_names += [f"{name}.{item}" for item in record.constraint_names]
    layout.speed_conditions += [f"{name}.{item}" for item in record.speed_conditions]


def _states(layout: Layout, piece: Piece) -> None:
    for key, values in piece.states.items():
        q = len(layout.q0)
        layout.states[piece.name, key] = _placed(layout.v0, layout.v_names, f"{piece.name}.{key}", values)
        if values.size:
            layout.segments.append(Segment("linear", q, layout.states[piece.name, key].start, values.size))
        layout.q0 += [0.0] * values.size
        layout.q_names += [f"{item}.integral" for item in layout.v_names[layout.states[piece.name, key].slice]]


def _inputs(layout: Layout, wired: Wired, name: str, piece: Piece) -> None:
    sampled = piece.block.samples()
    for port in wired.ports[name].outputs:
        shape, label = port.shape or (), f"{name}.{port.name}"
        if port.name in sampled:
            is_open = isinstance(piece.block, Inlet) and piece.block.is_open
            start = piece.block.start().reshape(shape) if isinstance(piece.block, Inlet) else np.zeros(shape)
            place = _placed(layout.u0, layout.u_names, label, start)
            layout.samples[name, port.name] = place
            layout.signals += [] if is_open else _columns(sampled[port.name], place)
        elif piece.is_discrete:
            layout.held[name, port.name] = _placed(layout.u0, layout.u_names, label, np.zeros(shape))
    for key, values in piece.memory.items():
        layout.memory[name, key] = _placed(layout.u0, layout.u_names, f"{name}.{key}", values)


def _columns(signal: Signal, place: Place) -> list[tuple[int, Array, Array, bool]]:
    values = signal.values.reshape(len(signal.t), -1)
    values = np.broadcast_to(values, (len(values), place.size))  # One number for all entries of an inlet.
    return [
        (place.start + i, signal.t, np.ascontiguousarray(values[:, i]), signal.kind == "linear")
        for i in range(place.size)
    ]


def _placed(into: list[float], names: list[str], label: str, values: Array) -> Place:
    place = Place(len(into), tuple(values.shape))
    into += values.reshape(-1).tolist()
    names += [label] if not values.shape else [f"{label}[{i}]" for i in range(values.size)]
    return place
