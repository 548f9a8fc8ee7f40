"""A recorded motion, and what follows from it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.base.html import html_table
from symofros.base.names import TIME, coordinate_of, speed_column, speed_of, symbol_of
from symofros.errors import UnknownNameError, did_you_mean
from symofros.runtime.beams import BeamBending
from symofros.runtime.model import ContactForces, Model
from symofros.simulation.analysis.sliding import contact_dynamics
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.plots import Panel, check_curves, draw
from symofros.simulation.results.saving import check_file, write_columns, write_npz
from symofros.simulation.results.section_forces import SectionForces, section_forces_of


class Found(NamedTuple):
    """An event that was met: its name, when, the state, and what its action did.

    Attributes:
        name: Name of the event.
        t: Instant [s].
        q: Configuration (nq).
        v: Speeds (nv), before the action.
        v_after: Speeds (nv) after the action; None where there is none.
        impulse: Impulse of the constraints in an impact (nc), of least norm where conditions repeat each other: M dv =
            G^T impulse [N s, N m s].
        energy_lost: Kinetic energy that the impact took; of balls that strike at once the first event has it all [J].
        energy_added: Energy that came with parameters and speeds that were set [J].
    """

    name: str
    t: float
    q: Array
    v: Array
    v_after: Array | None = None
    impulse: Array | None = None
    energy_lost: float = 0.0
    energy_added: float = 0.0

    def of(self, model: Model) -> Found:
        """The event of a run of a model's `carried` as one of the model."""
        after = None if self.v_after is None else self.v_after[: model.nv]
        return self._replace(q=self.q[: model.nq], v=self.v[: model.nv], v_after=after)


@dataclass(frozen=True)
class Statistics:
    """What a run cost.

    Attributes:
        method: Name of the method.
        steps: Accepted; `rejected` were tried in vain.
        evaluations: Evaluations of the accelerations; `jacobians` of their derivatives.
        seconds: Wall time in the stepping loop [s].
        late_steps: With a pace: steps that began after their time; `late_max` and `late_mean` [s] are how late the
            clock was, sleeping included.
        rank_min: Lowest rank of the constraints' Jacobian met, `rank_max` the highest; -1 without constraints.
        worked: Processor time of this thread in that loop [s]; NaN of a batch, which has several threads.
    """

    method: str
    steps: int
    rejected: int
    evaluations: int
    jacobians: int
    seconds: float
    late_steps: int = 0
    late_max: float = 0.0
    late_mean: float = 0.0
    rank_min: int = -1
    rank_max: int = -1
    worked: float = math.nan

    def and_then(self, other: Statistics) -> Statistics:
        """The cost of two parts of a run together; what is late was counted on."""
        summed = ("steps", "rejected", "evaluations", "jacobians", "seconds", "worked")
        sums = {name: getattr(self, name) + getattr(other, name) for name in summed}
        ranks = min(self.rank_min, other.rank_min), max(self.rank_max, other.rank_max)
        return replace(other, **sums, rank_min=ranks[0], rank_max=ranks[1])


class Frames(Mapping[str, tuple[Array, Array]]):
    """Frame name -> p_WF (n, 3) and R_WF (n, 3, 3) along a trajectory, computed when asked for."""

    def __init__(self, trajectory: Trajectory) -> None:
        self._trajectory = trajectory

    def __getitem__(self, name: str) -> tuple[Array, Array]:
        """Pose over time.

        Raises:
            KeyError: There is no such frame; an UnknownNameError, which says the nearest, of a text.
        """
        run = self._trajectory
        if not isinstance(name, str):
            raise KeyError(name)
        return run.model.frame_pose(name, run.q, u=run.u, par=run._par)

    def __iter__(self) -> Iterator[str]:
        """Names."""
        return iter(self._trajectory.model.names.frames)

    def __len__(self) -> int:
        """Number of frames."""
        return len(self._trajectory.model.names.frames)


@dataclass(frozen=True, repr=False)
class Trajectory:
    """States over time, of one run.

    Attributes:
        model: Model that was simulated.
        t: Times (n) [s].
        q: Configurations (n, nq).
        v: Speeds (n, nv).
        u: Inputs (n, nu).
        par: Run-time parameters (npar), at the start where events change them: see `par_over_time`.
        outcome: Outcome: how the run ended.
        events: Events met, in the order of time.
        statistics: Cost of the run: steps, evaluations, time.
        bendings: Bending of each beam at the step where its theory errs most.
        changes: Parameters (npar) that actions of events left, each with the number of the first record with them.
        z: States of forces (n, nz).
    """

    model: Model
    t: Array
    q: Array
    v: Array
    u: Array
    par: Array
    outcome: Outcome
    events: tuple[Found, ...] = ()
    statistics: Statistics = field(default_factory=lambda: Statistics("", 0, 0, 0, 0, 0.0))
    bendings: tuple[BeamBending, ...] = ()
    changes: tuple[tuple[int, Array], ...] = ()
    z: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def of(self, model: Model) -> Trajectory:
        """The run of a model's `carried` as one of the model: q, v and z apart."""
        if model.carried is model:
            return self
        events = tuple(found.of(model) for found in self.events)
        return replace(self, model=model, q=self.q[:, : model.nq], v=self.v[:, : model.nv], events=events)

    @property
    def _states(self) -> dict[str, Array]:
        """What functions of a model with states of forces take beside q and v."""
        return {"z": self.z} if self.model.nz else {}

    def __len__(self) -> int:
        """Number of recorded states."""
        return len(self.t)

    @cached_property
    def par_over_time(self) -> Array:
        """Run-time parameters at each record (n, npar)."""
        rows = np.tile(self.par, (len(self), 1))
        for first, par in self.changes:
            rows[first:] = par
        return rows

    @property
    def _par(self) -> Array:
        """Run-time parameters, of all records (npar) or of each (n, npar)."""
        return self.par_over_time if self.changes else self.par

    @cached_property
    def _dynamics(self) -> tuple[Array, Array]:
        return contact_dynamics(self.model, (self.t, self.q, self.v, self.u), self._par, **self._states)

    @property
    def a(self) -> Array:
        """Accelerations v' (n, nv) at the recorded states, constraints kept, without stabilising terms."""
        return self._dynamics[0]

    @property
    def lam(self) -> Array:
        """Multipliers (n, nc)."""
        return self._dynamics[1]

    @cached_property
    def kinetic_energy(self) -> Array:
        """(n) [J]."""
        return self.model.kinetic_energy(self.q, self.v, u=self.u, par=self._par)

    @cached_property
    def potential_energy(self) -> Array:
        """(n) [J]."""
        return self.model.potential_energy(self.q, u=self.u, par=self._par, t=self.t, **self._states)

    @property
    def energy(self) -> Array:
        """Kinetic and potential energy together (n) [J]."""
        total: Array = self.kinetic_energy + self.potential_energy
        return total

    def joint_wrenches(self) -> Array:
        """What each joint transmits from its parent to its body (n, joints, 6) [N, N m], as `Model.joint_wrenches`."""
        given: dict[str, Any] = {"par": self._par, "t": self.t, **self._states}
        return self.model.joint_wrenches(self.q, self.v, self.a, self.u, self.lam, **given)

    def closure_wrench(self, name: str, on: Literal["second", "first"] = "second") -> Array:
        """What a constraint exerts on one of its frames (n, 6) [N, N m], as `Model.closure_wrench`.

        Raises:
            UnknownNameError: There is no such constraint, or it is a condition by formula.
        """
        return self.model.closure_wrench(name, self.q, self.lam, on=on, u=self.u, par=self._par, t=self.t)

    def contact_forces(self) -> ContactForces:
        """Distances and forces of all contacts, rigid ones included (n, ...), as `Model.contact_forces`."""
        given: dict[str, Any] = {"lam": self.lam, "par": self._par, "t": self.t, **self._states}
        return self.model.contact_forces(self.q, self.v, self.u, **given)

    def section_forces(self, beam: str) -> SectionForces:
        """Force and moment inside an elastic beam at its stations, over time.

        Args:
            beam: Name of the beam; of a beam in segments, of one of them.

        Raises:
            UnknownNameError: There is no such elastic beam.
        """
        states = self.q, self.v, self.a, self.u, self.lam
        return section_forces_of(self.model, beam, self.t, states, self._par, self._states)

    @property
    def frames(self) -> Frames:
        """Frame name -> (p (n, 3), R (n, 3, 3))."""
        return Frames(self)

    def __getitem__(self, name: str) -> Array:
        """A coordinate, speed ("d" and the coordinate's name, or its own) or input by name (n).

        Raises:
            UnknownNameError: There is none of that name.
        """
        names = self.model.names
        name = str(name)
        for known, values in ((names.q, self.q), (names.u, self.u)):
            if found := coordinate_of(name, known):
                return values[:, known.index(found)]
        if found := speed_of(name, names.v):
            return self.v[:, names.v.index(found)]
        if name in names.z:
            return self.z[:, names.z.index(name)]
        columns = tuple(self.columns())
        listed = ", ".join(columns[:12]) + (", …" if len(columns) > 12 else "")
        raise UnknownNameError(
            f"trajectory of '{self.model.record.name}': no '{str(name)[:80]}'",
            listed,
            "names are of coordinates, speeds and inputs",
            did_you_mean(str(name)[:80], columns) or "see trajectory.columns(); frames are in trajectory.frames",
        )

    def __repr__(self) -> str:
        """Model, method, sizes and outcome; the numbers are in its attributes."""
        name, method = self.model.record.name, self.statistics.method
        span = f"t = {self.t[0]:.6g} … {self.t[-1]:.6g} s" if len(self.t) else "no records"
        return f"<Trajectory of '{name}' by {method}: {len(self)} records, {span}; {self.outcome}>"

    def _repr_html_(self) -> str:
        """The same for notebooks, with the range of each column."""
        columns = self.columns() if len(self) else {}
        rows = [(name, f"{values.min():.6g} … {values.max():.6g}") for name, values in columns.items()]
        return html_table(repr(self).strip("<>"), ("name", "range"), rows)

    def columns(self) -> dict[str, Array]:
        """Time, coordinates, speeds and inputs by name (n); a speed that shares its coordinate's name gets a d.

        A coordinate called t is in the column "`t`".
        """
        names = self.model.names
        columns_by_name = {TIME: self.t} | {symbol_of(name): self.q[:, i] for i, name in enumerate(names.q)}
        columns_by_name |= {speed_column(name, names.q): self.v[:, i] for i, name in enumerate(names.v)}
        columns_by_name |= {name: self.z[:, i] for i, name in enumerate(names.z)}
        return columns_by_name | {
            (name if name not in columns_by_name else f"u.{name}"): self.u[:, i] for i, name in enumerate(names.u)
        }

    def plot(self, *names: str) -> Any:
        """A Matplotlib figure of coordinates, speeds, inputs (those named) and energy; `.savefig(path)` writes it.

        A panel shows its first 12 curves, and says how many there are.

        Raises:
            SymofrosError: Matplotlib is not installed.
            UnknownNameError: A name is none of a coordinate, speed or input.
        """
        check_curves(self.model, names)
        known = self.model.names
        panels = {
            "coordinates [rad, m]": _curves(known.q, self.q, names),
            "speeds [rad/s, m/s]": _curves(known.v, self.v, names),
            "change of energy [J]": {"kinetic + potential": self.energy - self.energy[0]},
        }
        if self.u.any():
            panels["inputs [N m, N]"] = _curves(known.u, self.u, names if {*names} & {*known.u} else ())
        shown = [Panel(label, curves) for label, curves in panels.items() if curves]
        title = f"{self.model.record.name}: {self.statistics.method}, {self.outcome.kind} at t = {self.outcome.t:.4g} s"
        return draw(self.t, shown, title)

    @checked
    def save(self, path: str | Path) -> Path:
        """Write the trajectory: .npz (arrays), .csv or .parquet (a column a name).

        Raises:
            SymofrosError: Another suffix; or Parquet without pyarrow.
        """
        path = Path(path)
        check_file(path, "trajectory")
        if path.suffix == ".npz":
            arrays: dict[str, Any] = {"t": self.t, "q": self.q, "v": self.v, "u": self.u, "par": self.par}
            names = self.model.names
            arrays |= {"par_over_time": self.par_over_time} if self.changes else {}
            arrays |= {"z": self.z, "names_z": names.z} if names.z else {}
            write_npz(
                path,
                {**arrays, "names_q": names.q, "names_v": names.v, "names_u": names.u, "outcome": str(self.outcome)},
            )
        else:
            write_columns(path, self.columns(), "trajectory")
        return path


def _curves(names: tuple[str, ...], values: Array, chosen: tuple[str, ...]) -> dict[str, Array]:
    """Columns by name: those chosen, or all."""
    return {name: values[:, i] for i, name in enumerate(names) if not chosen or name in chosen}
