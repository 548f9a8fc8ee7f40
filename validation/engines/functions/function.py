"""One function that engines are asked for, with its truth."""

from __future__ import annotations

from collections.abc import Mapping
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


def functions_of(rows: Mapping[str, tuple[str, TruthOf]], *needs: str) -> dict[str, Function]:
    """Functions by name, of rows of text and truth, that show in the same trees."""
    return {name: Function(text, truth, needs) for name, (text, truth) in rows.items()}
