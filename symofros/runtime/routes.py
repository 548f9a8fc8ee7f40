"""Which methods a model's functions are computed by, as `Model.routes` tells them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from symofros.base.routes import Choice

Key = tuple[str, str]


class Routes(Mapping[str, tuple[Choice, ...]]):
    """Choices of methods by function: "forward_dynamics", or "frame_pose of tip".

    It lists the functions made so far, and tells on request of every function that the model can have.

    Args:
        made: Gives name and frame of the functions made so far.
        tell: Gives the choices of a function, of its name and frame; raises UnknownNameError where there is none.
    """

    def __init__(self, made: Callable[[], Iterable[Key]], tell: Callable[[str, str], tuple[Choice, ...]]) -> None:
        self._made, self._tell = made, tell

    def __getitem__(self, name: str) -> tuple[Choice, ...]:
        """The choices of a function, in the order in which they were made."""
        function, _, frame = name.partition(" of ")
        return self._tell(function, frame)

    def __iter__(self) -> Iterator[str]:
        """Names of the functions made so far."""
        return iter([" of ".join(filter(None, key)) for key in self._made()])

    def __len__(self) -> int:
        """How many functions were made so far."""
        return len(list(self._made()))

    def __str__(self) -> str:
        """One line a choice, below its function."""
        return "\n".join("\n  ".join([name, *map(str, choices)]) for name, choices in self.items())
