"""The functions of an export as people read them: names in C, and the table of its README."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from symofros.base.c_text import comment
from symofros.base.functions import FUNCTIONS, INPUTS
from symofros.runtime.calls import Signature
from symofros.runtime.record import ModelRecord


@dataclass(frozen=True)
class NamedFunction:
    """A function under its name in C.

    Attributes:
        symbol: Name in C.
        signature: Inputs and outputs, in order.
    """

    symbol: str
    signature: Signature

    @property
    def summary(self) -> str:
        """One line for people."""
        frame = f", of frame {self.signature.frame}" if self.signature.frame else ""
        return comment(f"{FUNCTIONS[self.signature.name].summary}{frame}")


def functions_table(functions: Sequence[NamedFunction]) -> str:
    """Functions with inputs, outputs and shapes in the order of arguments, as a table of Markdown."""
    rows = [
        f"| `{function.symbol}` | {_arrays(function.signature.inputs)} | {_arrays(function.signature.outputs)} "
        f"| {cell(function.summary)} |"
        for function in functions
    ]
    return "\n".join(["| function | inputs | outputs | what it is |", "|---|---|---|---|", *rows])


def names_table(record: ModelRecord) -> str:
    """Entries of the inputs by the user's names, as a table of Markdown."""
    named = {
        "q": record.q_names,
        "v": record.v_names,
        "u": record.u_names,
        "par": record.par_names,
        "lam": record.constraint_names,
    }
    rows = [
        f"| `{group}` | {INPUTS[group][1]} | {len(names)} | {cell(', '.join(names))} |"
        for group, names in named.items()
        if names
    ]
    return "\n".join(["| array | what it is | entries | their names |", "|---|---|---|---|", *rows])


def cell(text: str) -> str:
    """Text that a cell of Markdown shows as it is."""
    plain = comment(text)
    return "".join(f"\\{letter}" if letter in "\\|`*_<>[]" else letter for letter in plain)


def _arrays(arrays: Iterable[tuple[str, int | tuple[int, ...]]]) -> str:
    return ", ".join(f"`{name}` {_size(size)}" for name, size in arrays) or "-"


def _size(size: int | tuple[int, ...]) -> str:
    sizes = (size,) if isinstance(size, int) else size
    return " x ".join(map(str, sizes)) or "number"


def states_note(record: ModelRecord) -> tuple[str, ...]:
    """What states of forces are called in an export, where there are some."""
    if not record.state_names:
        return ()
    listed = ", ".join(record.state_names)
    return (
        f"states of forces are the last speeds, their rates the last accelerations, beside idle coordinates: {listed}",
    )
