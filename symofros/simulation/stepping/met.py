"""Events that a loop of steps has met, as C notes them."""

from __future__ import annotations

from typing import NamedTuple

from symofros.base.arrays import Array
from symofros.native import native_number

_RESTS = int(native_number("stepping/events/actions.c", "SYM_RESTS"))


class Done(NamedTuple):
    """What an action has done: sym_done.

    Attributes:
        status: 1, or 2 where a contact came to rest; below zero: why it has failed.
        gap: |phi| by weight that engaging has closed.
        in_sequence: Whether balls of rigid contacts struck so because no motion was found in which they do at once.
        u: Inputs by which it acted (nu).
        v_set: Speeds that it set (nv).
        v_after: Speeds that the impact left (nv).
        q_after: Configuration then (nq).
        par: Run-time parameters before (npar).
        par_set: Those that it set (npar).
    """

    status: int
    gap: float
    in_sequence: bool
    u: Array
    v_set: Array
    v_after: Array
    q_after: Array
    par: Array
    par_set: Array

    @property
    def rests(self) -> bool:
        """Whether a contact came to rest by it: SYM_RESTS."""
        return self.status == _RESTS

    @classmethod
    def of(cls, row: Array, sizes: tuple[int, int, int, int]) -> Done | None:
        """What a row of numbers in that order says, sizes being nq, nv, nu, npar; None where nothing was done."""
        nq, nv, nu, npar = sizes
        if not row[0]:
            return None
        u, v_set, v_after, q_after, par, par_set = (
            part.copy() for part in _split(row[3:], (nu, nv, nv, nq, npar, npar))
        )
        return cls(int(row[0]), float(row[1]), bool(row[2]), u, v_set, v_after, q_after, par, par_set)


def _split(row: Array, sizes: tuple[int, ...]) -> list[Array]:
    parts, first = [], 0
    for size in sizes:
        parts.append(row[first : first + size])
        first += size
    return parts


class Met(NamedTuple):
    """An event that was met.

    Attributes:
        which: Its index.
        t: Instant [s].
        q: Configuration (nq).
        v: Speeds (nv), before the action.
        done: What its action has done, if it has one and it was its turn.
    """

    which: int
    t: float
    q: Array
    v: Array
    done: Done | None = None

    @property
    def acted(self) -> bool:
        """Whether its action has been done."""
        return self.done is not None and self.done.status > 0
