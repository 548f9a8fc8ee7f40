"""Forces inside a beam along a run, over its span: at an instant, and their envelope (docs/theory/beams.md, 9)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import UnknownNameError, did_you_mean
from symofros.runtime.model import Model
from symofros.simulation.results.plots import figure_class

COMPONENTS = ("N", "Vy", "Vz", "T", "My", "Mz")
_UNITS = ("N", "N", "N", "N m", "N m", "N m")
# Share of the largest force or moment below which a component counts as absent from a figure.
_ABSENT = 1e-9


@dataclass(frozen=True, eq=False)
class SectionForces:
    """Force N, Vy, Vz and moment T, My, Mz at the stations of one beam, over the records of a run.

    They are what the part beyond a station does to the part before it, along the axes of the section.

    Attributes:
        beam: Name of the beam.
        x: Stations, from the root along the axis (s) [m].
        t: Times (n) [s].
        values: Forces and moments (n, s, 6) [N, N m].
    """

    beam: str
    x: Array
    t: Array
    values: Array

    def __getitem__(self, component: str) -> Array:
        """One component over time and stations (n, s).

        Raises:
            UnknownNameError: There is none of that name.
        """
        if component not in COMPONENTS:
            raise UnknownNameError(
                f"section forces of beam '{self.beam}': no '{component}'",
                str(component),
                f"components are {', '.join(COMPONENTS)}",
                did_you_mean(str(component), COMPONENTS) or "name one of them",
            )
        return self.values[..., COMPONENTS.index(component)]

    @property
    def envelope(self) -> tuple[Array, Array]:
        """Smallest and largest value of each component at each station over the run (s, 6)."""
        return self.values.min(axis=0), self.values.max(axis=0)

    def at(self, t: float) -> Array:
        """Forces and moments at an instant, linear between records (s, 6)."""
        i = int(np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, max(len(self.t) - 2, 0)))
        k = min(i + 1, len(self.t) - 1)
        gap = self.t[k] - self.t[i]
        share = float(np.clip((t - self.t[i]) / gap, 0.0, 1.0)) if gap > 0.0 else 0.0
        return np.asarray((1.0 - share) * self.values[i] + share * self.values[k])

    @property
    def present(self) -> tuple[str, ...]:
        """Components that do not vanish in the run, beside the largest force and the largest moment."""
        largest = np.abs(self.values).max(axis=(0, 1), initial=0.0)
        scales = np.repeat([largest[:3].max(), largest[3:].max()], 3)
        return tuple(
            name for name, size, scale in zip(COMPONENTS, largest, scales, strict=True) if size > _ABSENT * scale
        )

    def plot(self, t: float | None = None) -> Any:
        """A Matplotlib figure over the span: the envelope of each component, and its values at an instant.

        Args:
            t: Instant [s]; the last record if not given.

        Raises:
            SymofrosError: Matplotlib is not installed.
        """
        at = float(self.t[-1]) if t is None else t
        names = self.present or COMPONENTS[:1]
        figure = figure_class()(figsize=(8.0, 1.8 * len(names)), layout="constrained")
        axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        (low, high), now = self.envelope, self.at(at)
        for axis, name in zip(axes, names, strict=True):
            k = COMPONENTS.index(name)
            axis.fill_between(self.x, low[:, k], high[:, k], alpha=0.25, linewidth=0, label="envelope")
            axis.plot(self.x, now[:, k], marker=".", label=f"t = {at:.4g} s")
            axis.set_ylabel(f"{name} [{_UNITS[k]}]")
            axis.grid(alpha=0.3)
        axes[0].legend(fontsize="small")
        axes[-1].set_xlabel("x [m]")
        figure.suptitle(f"section forces of beam '{self.beam}'")
        return figure


def section_forces_of(
    model: Model,
    beam: str,
    t: Array,
    states: tuple[Array, Array, Array, Array, Array],
    par: Array,
    of_forces: Mapping[str, Array],
) -> SectionForces:
    """Section forces of one beam along a motion.

    Args:
        model: Model that moved.
        beam: Name of an elastic beam.
        t: Times (n) [s].
        states: q, v, v', u and multipliers (n, ...).
        par: Run-time parameters (npar), or (n, npar) that have the same beams.
        of_forces: States of forces (n, nz), as "z", where there are some.

    Raises:
        UnknownNameError: The model has no such elastic beam with stations.
    """
    sections = model.names.sections
    rows = [k for k, (name, _) in enumerate(sections) if name == beam]
    if not rows:
        known = tuple(dict.fromkeys(name for name, _ in sections))
        raise UnknownNameError(
            f"trajectory of '{model.record.name}': no section forces of '{beam}'",
            ", ".join(known) or "no elastic beam with stations",
            "section forces are of elastic beams, at their stations; segments are beams: b, b.2 and so on",
            did_you_mean(beam, known) or "state stations, and shape functions in one direction at least",
        )
    length = next(one.length for one in model.beams(par if par.ndim == 1 else par[0]) if one.name == beam)
    x = length * np.array([sections[k][1] for k in rows])
    values = model.section_forces(*states, par=par, t=t, **of_forces)[..., rows, :]
    return SectionForces(beam, x, t, values)
