"""The states of a simulated run, out of the result that the page holds."""

from __future__ import annotations

from typing import Any

import numpy as np

from symofros.studio.viewer.playing.motion import States


def states_of(run: dict[str, Any]) -> States:
    """The states of a run, whose values are null where it diverged.

    Args:
        run: Result of the simulation, as `operations.simulate` gives it.
    """

    def columns(kind: str) -> np.ndarray:
        values = [series["values"] for series in run["series"] if series["kind"] == kind]
        return np.array(values, dtype=np.float64).T.reshape(len(run["t"]), len(values))

    return States(np.array(run["t"], dtype=np.float64), columns("q"), columns("u"), run["par"])
