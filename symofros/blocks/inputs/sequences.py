"""Sequences over time, of torques, trajectories or perturbations: given, or read from a file (section 6.1)."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import choice, increasing, known_name, numbers, path_text, refuse
from symofros.diagrams.block import Block, Environment, Port, Ports
from symofros.errors import DescriptionError
from symofros.simulation.inputs import Signal
from symofros.simulation.results.csv_columns import LineError, read_csv
from symofros.simulation.results.npz import TooLargeError, read_npz

# A file is read whole.
MAX_BYTES = 256_000_000
MAX_NUMBERS = 20_000_000
# A column of a saved run: name and unit.
_STATED_UNIT = re.compile(r"(.+) \[([^\[\]]*)\]")


@dataclass(frozen=True, kw_only=True)
class Sequence(Block):
    """Outputs given by samples over time; beyond their ends the first and last value hold.

    A CSV file has a line of names, one of them t, then numbers; of one that a run was saved to, whose times are called
    "t [s]", names stand without units, and outputs take these. An NPZ file has arrays by name, one of them t (n), the
    others (n) or (n, m).

    Attributes:
        t: Times (n) [s], where values are given here.
        values: One output y (n) or (n, m), or a mapping from outputs to such.
        file: File that they are read from instead, once, when the block is made.
        outputs: Output -> name, or names, of what it consists of in the file; none: one output y of all but t.
        kind: "linear" between samples, or "hold" each until the next.
        units: Output -> unit.
    """

    t: Any = None
    values: Any = None
    file: str = ""
    outputs: Any = None
    kind: str = "linear"
    units: Any = None

    def __post_init__(self) -> None:
        """Samples at increasing times."""
        object.__setattr__(self, "file", path_text(self.name, "file", self.file))
        choice(self.name, "kind", self.kind, ("linear", "hold"))
        if bool(self.file) == (self.values is not None):
            raise refuse(
                self.name,
                "no samples" if not self.file else "samples twice",
                "neither file nor values" if not self.file else "file and values",
                "samples are given, or read from a file",
                "state one of them",
            )
        signals = self._signals
        for name in dict(self.units or {}):
            known_name(self.name, "output", name, signals)

    @cached_property
    def _signals(self) -> dict[str, Signal]:
        """Output -> samples."""
        arrays = dict(self._columns[0])
        if "t" not in arrays or len(arrays) < 2:
            raise refuse(
                self.name,
                "no times",
                f"only {', '.join(arrays)}" if arrays else "nothing",
                "samples have times t and values",
                "add them",
            )
        t = increasing(self.name, "t", arrays.pop("t"), 1)
        signals = {}
        for output, names in self._chosen(list(arrays)).items():
            alone = isinstance(names, str)
            parts = [self._part(arrays, name, len(t)) for name in ([names] if alone else names)]
            values = parts[0] if alone else np.concatenate([part.reshape(len(t), -1) for part in parts], axis=1)
            signals[output] = Signal(t, values, "linear" if self.kind == "linear" else "hold")
        return signals

    def _chosen(self, names: list[str]) -> dict[str, Any]:
        """Output -> name or names of arrays."""
        if self.outputs:
            return dict(self.outputs)
        if not self.file:
            return {name: name for name in names}
        return {"y": names}

    def _part(self, arrays: Mapping[str, Any], name: str, size: int) -> Array:
        known_name(self.name, "column", name, arrays)
        values = numbers(self.name, f"'{name:.40}'", arrays[name])
        if values.ndim not in (1, 2) or len(values) != size:
            raise refuse(
                self.name,
                f"'{name:.40}' does not fit t",
                values.shape,
                f"({size}) or ({size}, any)",
                "one row of values a time",
            )
        return values

    @cached_property
    def _columns(self) -> tuple[dict[str, Any], dict[str, str]]:
        """Arrays by name, and units of those of a saved run, whose columns are called "t [s]" and the like."""
        arrays = self._arrays()
        if not self.file or "t" in arrays or "t [s]" not in arrays:
            return arrays, {}
        parts = {name: _STATED_UNIT.fullmatch(name) for name in arrays}
        names = {name: match[1] if match else name for name, match in parts.items()}
        if len({*names.values()}) < len(names):
            return arrays, {}
        units = {match[1]: match[2] for match in parts.values() if match}
        return {names[name]: values for name, values in arrays.items()}, units

    def _output_units(self) -> dict[str, str]:
        """Output -> unit that is stated, or that all its columns have."""
        arrays, of_columns = self._columns
        found = {}
        for output, names in self._chosen([name for name in arrays if name != "t"]).items():
            units = {of_columns.get(name, "") for name in ([names] if isinstance(names, str) else names)}
            found[output] = units.pop() if len(units) == 1 else ""
        return {**found, **dict(self.units or {})}

    def _arrays(self) -> dict[str, Any]:
        if self.file:
            return _read(self.name, Path(self.file))
        values = dict(self.values) if isinstance(self.values, Mapping) else {"y": self.values}
        return {"t": self.t, **values}

    def ports(self, environment: Environment) -> Ports:
        """The outputs."""
        units = self._output_units()
        return Ports(
            (),
            tuple(Port(name, signal.values.shape[1:], units.get(name, "")) for name, signal in self._signals.items()),
        )

    def samples(self) -> Mapping[str, Signal]:
        """All of them."""
        return self._signals


def _read(block: str, path: Path) -> dict[str, Any]:
    """Arrays of a file, by name.

    Raises:
        DescriptionError: It is missing, too large, or not what its ending says.
    """
    try:
        size, is_file = path.stat().st_size, path.is_file()
    except OSError as error:
        raise refuse(
            block, f"file '{path}'", error.strerror or "unreadable", "an existing file", "mend the path"
        ) from None
    if not is_file:  # A pipe would be waited for.
        raise refuse(block, f"file '{path}'", "a folder, a pipe or the like", "samples are in a file", "mend the path")
    if size > MAX_BYTES:
        raise refuse(block, f"file '{path}' is too large", f"{size} bytes", f"at most {MAX_BYTES}", "thin it out")
    if path.suffix.lower() not in _READERS:
        raise refuse(
            block, f"file '{path}' of unknown kind", repr(path.suffix), "names end in .csv or .npz", "convert it"
        )
    form, read = _READERS[path.suffix.lower()]
    try:
        arrays = dict(read(path, MAX_NUMBERS))
    except TooLargeError as error:
        what, rule = f"file '{path}' is too large", f"at most {MAX_NUMBERS} numbers in all its arrays"
        raise refuse(block, what, error, rule, "thin it out") from None
    except LineError as error:
        what, found, rule = "a line of samples", ",".join(error.content)[:120], f"{error.columns} numbers a line"
        where = f"{path}:{error.line}"
        raise DescriptionError(f"block '{block}': {what}", found, rule, "mend the line", where) from None
    except (OSError, ValueError, csv.Error) as error:
        raise refuse(
            block, f"file '{path}' is no {form}", error, "arrays of numbers by names", "write it anew"
        ) from None
    if "" in arrays:
        rule = "the first line names each column, once"
        raise refuse(block, f"file '{path}': names", ", ".join(arrays), rule, "mend the first line")
    return arrays


# Ending of a file -> what it is called, and what reads it.
_READERS: dict[str, tuple[str, Callable[[Path, int], Mapping[str, Any]]]] = {
    ".csv": ("CSV file", read_csv),
    ".npz": ("NPZ file", read_npz),
}
