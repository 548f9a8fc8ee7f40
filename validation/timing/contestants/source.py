"""C of one function as a symbolic peer writes it, and what it took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Source:
    """One function as C text, with CasADi's signature.

    Attributes:
        name: Name of the function, ours and in C.
        text: C.
        inputs: Groups of the states it reads, in order.
        sizes: Sizes of its outputs.
        scratch: Doubles and integers it works with.
        operations: Executed.
        seconds: Time from the description to the text [s].
    """

    name: str
    text: str
    inputs: tuple[str, ...]
    sizes: tuple[int, ...]
    scratch: tuple[int, int]
    operations: Mapping[str, int]
    seconds: float
