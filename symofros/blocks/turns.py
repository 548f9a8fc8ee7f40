"""What serves one run at a time, and outlasts it."""

from __future__ import annotations

import threading

from symofros.errors import SymofrosError


class Turn:
    """Whose turn it is: a page in a browser shows one run, then perhaps the next."""

    def __init__(self) -> None:
        self._taken = threading.Lock()

    def take(self, block: str) -> None:
        """Begin.

        Raises:
            SymofrosError: Another run has begun and not ended.
        """
        if not self._taken.acquire(blocking=False):
            raise SymofrosError(
                f"block '{block}': its page shows another run",
                "two runs at once",
                "a page shows one run at a time",
                "let the other end first, or give this diagram a block of its own",
            )

    def leave(self) -> None:
        """End: the next may begin."""
        self._taken.release()
