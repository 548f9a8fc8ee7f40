"""Many runs: how each ended, and what to look at first."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from symofros.errors import ShapeError
from symofros.simulation.results.ends import ENDS
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.stepping.status import Status

Index = int | tuple[int, ...]

# Runs whose steps the summary of a batch looks at.
_EXAMINED = 8


class Runs(ABC):
    """Runs of a model or of a diagram, whose batch dimensions are written (...).

    Attributes:
        status: Last status code of each (...); `kinds` and `outcome` state it as text.
    """

    status: npt.NDArray[np.int32]

    @property
    def shape(self) -> tuple[int, ...]:
        """The batch dimensions."""
        return self.status.shape

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """Which runs came to their end (...)."""
        return np.asarray(self.status == Status.FINISHED)

    @property
    def kinds(self) -> npt.NDArray[np.str_]:
        """Kind of each run's Outcome, as a word (...): how the run ended."""
        return np.asarray(np.vectorize(lambda status: ENDS[int(status)].kind, otypes=["U16"])(self.status))

    @abstractmethod
    def outcome(self, index: Index) -> Outcome:
        """Outcome of one run; its steps and inputs are examined at this call, which takes as long as a single run."""

    def number(self, index: Index) -> int:
        """Number of a run among all; `index` addresses all batch dimensions.

        Raises:
            ShapeError: It leaves some of them out.
        """
        found = np.arange(self.status.size).reshape(self.shape)[index]
        if np.ndim(found):
            what, rule = f"runs: index {index} is not that of one run", f"an index into all of {self.shape}"
            raise ShapeError(what, f"runs of shape {np.shape(found)}", rule, "number each dimension")
        return int(found)

    def __len__(self) -> int:
        """Number of runs."""
        return self.status.size

    @property
    def ends(self) -> str:
        """How many runs ended in which way, in words."""
        kinds, counts = np.unique(self.kinds, return_counts=True)
        return ", ".join(f"{count} {kind}" for kind, count in zip(kinds, counts, strict=True))

    def first_failure(self) -> Iterator[str]:
        """The outcome of the first run that did not come to its end, in words; nothing where all did."""
        for index in indices(~self.ok)[:1]:
            yield f"  first: {list(index)}: {self.outcome(index)}"

    def examined(self) -> list[tuple[int, ...]]:
        """Indices of the runs whose steps the summary looks at: some of those that came to their end."""
        good = indices(self.ok)
        return good[:: max(1, -(-len(good) // _EXAMINED))]


def indices(which: npt.NDArray[np.bool_]) -> list[tuple[int, ...]]:
    """Indices of the runs that are marked, in order."""
    return [tuple(map(int, row)) for row in np.argwhere(which)]
