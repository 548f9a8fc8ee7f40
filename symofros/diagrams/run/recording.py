"""The recording of a run of a diagram: states over time, and any signal computed from them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.block import Shape
from symofros.diagrams.program.compiled import CompiledDiagram
from symofros.diagrams.program.fused_functions import AFTER
from symofros.diagrams.wiring import Source
from symofros.errors import Problem, UnknownNameError, did_you_mean
from symofros.runtime.beams import BeamBending
from symofros.simulation.results.outcome import Outcome


class Crossed(NamedTuple):
    """A crossing that was met."""

    block: str
    crossing: str
    t: float


@dataclass(frozen=True)
class Cost:
    """What a run took.

    Attributes:
        steps: Accepted, of all parts together.
        rejected: Tried in vain.
        evaluations: Number of evaluations of the accelerations.
        seconds: Wall time in the loop [s].
        worked: Processor time of the processor, by the calling thread [s].
        late: Lateness of each instant (n) [s]; empty unless pace was kept.
        spacing: The shortest time between two instants, on the clock where pace was kept [s].
    """

    steps: int
    rejected: int
    evaluations: int
    seconds: float
    worked: float
    late: Array = field(default_factory=lambda: np.zeros(0))
    spacing: float = math.inf


@dataclass(frozen=True)
class Records:
    """Recorded states, and any signal computed from them.

    Attributes:
        compiled: Compiled diagram.
        t: Times (n) [s].
        q: Configurations (n, nq) of all mechanisms.
        v: Speeds and continuous states (n, nv).
        u: Inputs, held between samples (n, nu).
        par: Run-time parameters.
    """

    compiled: CompiledDiagram
    t: Array
    q: Array
    v: Array
    u: Array
    par: Array
    _known: dict[Source, Array] = field(default_factory=dict, kw_only=True)

    def __getitem__(self, name: str) -> Array:
        """A signal over time (n, *shape).

        Raises:
            DescriptionError: There is no such output.
        """
        source = self.compiled.resolved.wired.output(name)
        if source not in self._known:
            self.compute([source])
        return self._known[source]

    def unit(self, name: str) -> str:
        """Unit of a signal, by the signal's name."""
        wired = self.compiled.resolved.wired
        return wired.unit(wired.output(name))

    def shape(self, name: str) -> Shape:
        """Shape of a signal at one time, by the signal's name."""
        wired = self.compiled.resolved.wired
        return wired.shape(wired.output(name))

    def compute(self, sources: Sequence[Source]) -> None:
        """Make several signals known by one compiled function."""
        wanted = [source for source in sources if source not in self._known]
        if not wanted:
            return
        kernel = self.compiled.signals(wanted)
        pre = kernel.prepare(self.par.reshape(1, -1))
        known = {"q": self.q, "v": self.v, "u": self.u, "t": self.t[:, np.newaxis]}
        arrays = [known[group] if group in known else self._after[AFTER.index(group) - 4] for group in AFTER]
        n = len(self.t)
        (values,) = kernel.run(n, pre, [np.ascontiguousarray(a) for a in arrays])
        at, wired = 0, self.compiled.resolved.wired
        for source in wanted:
            size = math.prod(wired.shape(source))
            self._known[source] = values[:, at : at + size].reshape(n, *wired.shape(source))
            at += size

    @cached_property
    def _after(self) -> tuple[Array, Array]:
        """Accelerations (n, nv) and multipliers (n, nc) along the run."""
        parts, layout = self.compiled.parts, self.compiled.resolved.layout
        a, lam = np.zeros((len(self.t), len(layout.v0))), np.zeros((len(self.t), len(layout.condition_names)))
        for part, model in zip(layout.parts, parts, strict=True):
            if model.nc:  # Those of the others are written out in the signals themselves.
                a[:, part.v], lam[:, part.conditions], _ = model.constrained_dynamics(
                    self.q[:, part.q], self.v[:, part.v], self.u, par=self.par, t=self.t
                )
        return a, lam


@dataclass(frozen=True)
class Recording(Records, Mapping[str, Array]):
    """The records of a whole run: signals over time, `run["block.port"]`, computed when they are asked for.

    Attributes:
        outcome: Outcome of the run.
        crossings: Crossings met, in the order of time.
        cost: Cost of the run.
        bendings: Bending of each beam at the step where its theory errs most.
        kept: Block -> what it kept of the run by itself, by name: arrays at its own times "t", or counts.
    """

    outcome: Outcome
    crossings: tuple[Crossed, ...]
    cost: Cost
    bendings: tuple[BeamBending, ...] = ()
    kept: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)

    def __repr__(self) -> str:
        """Diagram, sizes and outcome; the numbers are in its attributes."""
        span = f"t = {self.t[0]:.6g} … {self.t[-1]:.6g} s" if len(self.t) else "no records"
        name = self.compiled.resolved.wired.name
        return (
            f"<{type(self).__name__} of '{name}': {len(self.t)} records of {len(self)} outputs, {span}; {self.outcome}>"
        )

    def __iter__(self) -> Iterator[str]:
        """Names of all outputs."""
        wired = self.compiled.resolved.wired
        return (f"{block}.{port.name}" for block in wired.ports for port in wired.ports[block].outputs)

    def __len__(self) -> int:
        """Number of outputs of all blocks of the diagram."""
        return sum(len(ports.outputs) for ports in self.compiled.resolved.wired.ports.values())

    def motion(self, block: str) -> tuple[Array, Array]:
        """Configurations (n, nq) and speeds (n, nv) of the mechanism that a block moves."""
        layout = self.compiled.resolved.layout
        if block not in layout.q:
            known = ", ".join(layout.q) or "none"
            what, remedy = f"block '{block}' moves no mechanism", did_you_mean(block, layout.q) or "name a plant's"
            raise UnknownNameError(Problem(what, f"those that do: {known}", "motions are of mechanisms", remedy))
        return self.q[:, layout.q[block].slice], self.v[:, layout.v[block].slice]
