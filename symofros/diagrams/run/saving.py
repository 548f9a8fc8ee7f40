"""A run of a diagram as files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from symofros.base.arrays import Array
from symofros.diagrams.run.recording import Recording
from symofros.diagrams.signals import check_entry, entries, split
from symofros.simulation.results.saving import refuse_suffix, write_columns, write_npz


def save_run(run: Recording, path: Path, signals: Iterable[str]) -> list[Path]:
    """Write a run.

    Args:
        run: Run to write.
        path: .npz: an array (n, *shape) a signal, "names" and "units" beside them. .csv, .parquet: a column an entry,
            named "block.port[i]", with its unit; what blocks kept at times of their own goes to NAME.BLOCK.csv.
        signals: Outputs, or entries of them; all of them by default.

    Returns:
        The files.

    Raises:
        SymofrosError: Another suffix; no such signal; Parquet without pyarrow.
    """
    refuse_suffix(path, "run")
    wanted = list(signals) or list(run)
    run.compute([run.compiled.resolved.wired.output(split(name)[0]) for name in wanted])
    if path.suffix == ".npz":
        _save_npz(run, path, wanted)
        return [path]
    table = columns(run, wanted)
    units = {name: "s" if name == "t" else run.unit(split(name)[0]) for name in table}
    write_columns(path, table, "run", units)
    files = [path]
    for block, arrays in run.kept.items():
        if "t" not in arrays:
            continue  # Counts, not signals over time.
        files.append(path.with_name(f"{path.stem}.{block.replace('/', '.')}{path.suffix}"))
        write_columns(files[-1], spread(arrays), "run")
    return files


def _save_npz(run: Recording, path: Path, wanted: list[str]) -> None:
    names = list(dict.fromkeys(split(name)[0] for name in wanted))
    arrays = {"t": run.t} | {name: run[name] for name in names}
    for block, kept in run.kept.items():
        arrays |= {f"{block}.{name}": values for name, values in kept.items()}
    units = ["s", *map(run.unit, names)]
    write_npz(path, {**arrays, "names": ["t", *names], "units": units, "outcome": str(run.outcome)})


def columns(run: Recording, wanted: Iterable[str]) -> dict[str, Array]:
    """Time and entries of signals by name (n).

    Raises:
        DescriptionError: A signal has no such entry.
    """
    columns_by_name = {"t": run.t}
    for text in wanted:
        name, index = split(text)
        check_entry(text, index, run.shape(name))
        flat = run[name].reshape(len(run.t), -1)
        for k, (label, at) in enumerate(entries(name, run.shape(name))):
            if index is None or index == at:
                columns_by_name[label] = flat[:, k]
    return columns_by_name


def spread(arrays: Mapping[str, Array]) -> dict[str, Array]:
    """Arrays (n, *shape) as columns (n)."""
    return {
        label: values.reshape(len(values), -1)[:, k]
        for name, values in arrays.items()
        for k, (label, _) in enumerate(entries(name, values.shape[1:]))
    }
