"""Names for what an MJCF model leaves unnamed: stable from one reading to the next, and unique."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.description.reading import fresh_name


class Names:
    """The names of all things of a kind.

    Args:
        kind: Prefix of the names of nameless elements, before the index.
        stated: Names as in the model, "" for none.
    """

    def __init__(self, kind: str, stated: Sequence[str]) -> None:
        self._taken = {name for name in stated if name}
        self._names = [name or self.fresh(f"{kind}{i}") for i, name in enumerate(stated)]

    def __getitem__(self, index: int) -> str:
        """The name of one."""
        return self._names[index]

    def fresh(self, wanted: str) -> str:
        """The wanted name, with underscores behind it while it is taken; it is taken then."""
        return fresh_name(wanted, self._taken)
