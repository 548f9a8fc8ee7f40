"""The recording of a run of a diagram: states over time, and any signal computed from them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.block import Shape
from symofros.diagrams.program.compiled import CompiledDiagram
from symofros.diagrams.program.point import AFTER
from symofros.diagrams.wiring import Source
from symofros.runtime.calls import Kernel
from symofros.simulation.analysis.sliding import contact_dynamics
from symofros.simulation.results.trajectory import Statistics

_ALL = slice(None)


class Crossed(NamedTuple):
    """A crossing that was met."""

    block: str
    crossing: str
    t: float


@dataclass(frozen=True)
class Cost(Statistics):
    """Computational cost of a run, of all its parts together.

    Attributes:
        late: Lateness of each instant (n) [s]; empty unless pace was kept.
        spacing: The shortest time between two instants, on the clock where pace was kept [s].
    """

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
        self._known.update(self.evaluated(wanted, self.compiled.signals(wanted)))

    def evaluated(self, sources: Sequence[Source], kernel: Kernel, rows: slice = _ALL) -> dict[Source, Array]:
        """Outputs at some of the records, by a function of `CompiledDiagram.signals` that gives them."""
        pre = kernel.prepare(self.par.reshape(1, -1))
        known = {"q": self.q, "v": self.v, "u": self.u, "t": self.t[:, np.newaxis]}
        arrays = [known[group] if group in known else self._after[AFTER.index(group) - 4] for group in AFTER]
        n = len(self.t[rows])
        (found,) = kernel.run(n, pre, [np.ascontiguousarray(a[rows]) for a in arrays])
        at, wired, values = 0, self.compiled.resolved.wired, dict[Source, Array]()
        for source in sources:
            size = math.prod(wired.shape(source))
            values[source] = found[:, at : at + size].reshape(n, *wired.shape(source))
            at += size
        return values

    @cached_property
    def _after(self) -> tuple[Array, Array]:
        """Accelerations (n, nv) and multipliers (n, nc) along the run."""
        parts, layout = self.compiled.parts, self.compiled.resolved.layout
        par = layout.present(self.par, self.u)
        a, lam = np.zeros((len(self.t), len(layout.v0))), np.zeros((len(self.t), len(layout.condition_names)))
        for part, model in zip(layout.parts, parts, strict=True):
            if model.nc:  # Those of the others are written out in the signals themselves.
                states = self.t, self.q[:, part.q], self.v[:, part.v], self.u
                a[:, part.v], lam[:, part.conditions] = contact_dynamics(model, states, par)
        return a, lam
