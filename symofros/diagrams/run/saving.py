"""Signals of a run of a diagram as columns, one for each entry of a signal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from symofros.base.arrays import Array
from symofros.diagrams.run.recording import Records
from symofros.diagrams.signals import check_entry, entries, split


def columns(run: Records, wanted: Iterable[str]) -> dict[str, Array]:
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
