"""Which methods a model's functions are computed by, as `Model.routes` tells them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from symofros.base.route import Choice
from symofros.errors import SymofrosError
from symofros.runtime.functions import Functions, Key


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
        """Number of functions made so far."""
        return len(list(self._made()))

    def __str__(self) -> str:
        """One line a choice, below its function."""
        return "\n".join("\n  ".join([name, *map(str, choices)]) for name, choices in self.items())


class RouteFunctions(Functions):
    """Methods of a model that tell how its functions are computed."""

    @property
    def routes(self) -> Routes:
        """Which method computes each function made so far, and why: the choices by name of the function.

        A choice names the quantity, the method taken, the figures that decided (counts of operations, say), the
        accuracy, where the theory is, and the other methods that apply with the options that ask for them;
        docs/operations.md has the table of all. `routes["forward_dynamics"]` tells of a function before its first call,
        too. What the cache holds was chosen by the same code from the same description: the choices are derived again
        when they are first asked for, which takes as long as generating the function. Batches and graphics processors
        compute by the same methods, without packs, loops or vectors of limbs.

        Raises:
            SymofrosError: The model came without its description.
        """
        return Routes(lambda: self._kernels, self._choices)

    def _choices(self, name: str, frame: str) -> tuple[Choice, ...]:
        if self._routes_of is None:
            raise SymofrosError(f"model '{self.record.name}': a model without its description tells no routes")
        public = self._frame_or_none(frame)
        self._check_name(name, public, "functions of frames are named with their frame: 'frame_pose of tip'")
        return self._routes_of(self._unit_of(name, public))[name, public]
