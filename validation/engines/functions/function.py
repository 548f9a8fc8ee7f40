"""One function that engines are asked for, with its truth."""

from __future__ import annotations

from dataclasses import dataclass

from ..truth.derived import TruthOf


@dataclass(frozen=True)
class Function:
    """One function of a tree and a state.

    Attributes:
        text: What it is, with shape and conventions.
        truth: Its value in many digits.
        needs: Of `Tree.demands`, those in any of which it shows; () for trees that state none.
    """

    text: str
    truth: TruthOf
    needs: tuple[str, ...] = ()
