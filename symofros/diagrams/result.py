"""A run of a diagram: its signals over time, and the ways to show it and to write it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.diagrams.run.plots import panels_of, plots_of
from symofros.diagrams.run.recording import Cost, Crossed, Records
from symofros.diagrams.run.saving import columns, spread
from symofros.diagrams.settings import Plot
from symofros.diagrams.signals import split
from symofros.errors import DescriptionError
from symofros.runtime.beams import BeamBending
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.plots import draw, show_windows, window_figure
from symofros.simulation.results.saving import check_file, write_columns, write_npz
from symofros.simulation.results.trajectory import Found


@dataclass(frozen=True, repr=False)
class DiagramRun(Records, Mapping[str, Array]):
    """The records of a whole run: signals over time, `run["block.port"]`, computed when they are asked for.

    Attributes:
        outcome: Outcome of the run.
        crossings: Crossings met, in the order of time.
        events: Block -> events of its mechanism, as `sf.Trajectory.events` has them.
        cost: Cost of the run.
        bendings: Bending of each beam at the step where its theory errs most.
        kept: Block -> what it kept of the run by itself, by name: arrays at its own times "t", or counts.
    """

    outcome: Outcome
    crossings: tuple[Crossed, ...]
    events: Mapping[str, tuple[Found, ...]]
    cost: Cost
    bendings: tuple[BeamBending, ...] = ()
    kept: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)

    def __repr__(self) -> str:
        """One line: name of the diagram, numbers of records and outputs, span of time, outcome."""
        span = f"t = {self.t[0]:.6g} … {self.t[-1]:.6g} s" if len(self.t) else "no records"
        name = self.compiled.resolved.wired.name
        return (
            f"<{type(self).__name__} of '{name}': {len(self.t)} records of {len(self)} outputs, {span}; {self.outcome}>"
        )

    def __iter__(self) -> Iterator[str]:
        """Names "block.port" of all outputs."""
        wired = self.compiled.resolved.wired
        return (f"{block}.{port.name}" for block in wired.ports for port in wired.ports[block].outputs)

    def __contains__(self, name: object) -> bool:
        """Whether a name is that of an output, as `run[name]` takes it; also of an outlet, or of a block with one."""
        try:
            return isinstance(name, str) and bool(self.compiled.resolved.wired.output(name))
        except DescriptionError:
            return False

    def get(self, name: str, default: Any = None) -> Any:
        """A signal over time; `default` where there is no such output."""
        return self[name] if name in self else default

    def __len__(self) -> int:
        """Number of outputs of all blocks of the diagram."""
        return sum(len(ports.outputs) for ports in self.compiled.resolved.wired.ports.values())

    def motion(self, block: str) -> tuple[Array, Array]:
        """Configurations (n, nq) and speeds (n, nv) of the mechanism that a block moves."""
        q, v = self.compiled.resolved.layout.moved(block)
        return self.q[:, q.slice], self.v[:, v.slice]

    @checked
    def save(self, path: str | Path, *signals: str) -> list[Path]:
        """Write signals "block.port" or "block.port[i]", all by default, to .npz, .csv or .parquet; returns the files.

        Into .npz an array (n, *shape) a signal, "names" and "units" beside them; into .csv and .parquet a column an
        entry, named "block.port[i]", with its unit. What blocks kept at times of their own goes to NAME.BLOCK.csv.

        Raises:
            SymofrosError: Another suffix; no such signal; Parquet without pyarrow.
        """
        path = Path(path)
        check_file(path, "run")
        wanted = list(signals) or list(self)
        names = list(dict.fromkeys(split(name)[0] for name in wanted))
        self.compute(list(map(self.compiled.resolved.wired.output, names)))
        if path.suffix == ".npz":
            arrays = {"t": self.t} | {name: self[name] for name in names}
            for block, kept in self.kept.items():
                arrays |= {f"{block}.{name}": values for name, values in kept.items()}
            stated = {"names": ["t", *names], "units": ["s", *map(self.unit, names)], "outcome": str(self.outcome)}
            write_npz(path, {**arrays, **stated})
            return [path]
        table = columns(self, wanted)
        units = {name: "s" if name == "t" else self.unit(split(name)[0]) for name in table}
        write_columns(path, table, "run", units)
        files = [path]
        for block, kept in self.kept.items():
            if "t" not in kept:
                continue  # Counts, not signals over time.
            files.append(path.with_name(f"{path.stem}.{block.replace('/', '.')}{path.suffix}"))
            write_columns(files[-1], spread(kept), "run")
        return files

    def plot(self, *signals: str, figure: Any = None) -> Any:
        """A Matplotlib figure of signals; by default what the diagram asks to be shown, or else every output.

        Raises:
            SymofrosError: Matplotlib is not installed, or there is no such signal.
        """
        wired, outcome = self.compiled.resolved.wired, self.outcome
        plots = [Plot(s, (s,)) for s in signals] or plots_of(wired) or [Plot(s, (s,)) for s in self]
        title = f"{wired.name}: {outcome.kind} at t = {outcome.t:.4g} s"
        return draw(self.t, panels_of(self, plots), title, figure)

    def show(self, *signals: str) -> None:
        """Draw signals, as `plot` does, in a window, and wait until it is closed.

        Raises:
            SymofrosError: Matplotlib is not installed, or has no screen to draw on.
        """
        self.plot(*signals, figure=window_figure())
        show_windows()
