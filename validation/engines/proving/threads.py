"""Public threads that know a fault: searched for by hand, one row a fault."""

from __future__ import annotations

import re
from typing import NamedTuple

NONE = "none found"


class Thread(NamedTuple):
    """A thread on a fault.

    Attributes:
        engine: Name of the engine.
        models: Pattern of the trees' names.
        functions: Pattern of the functions' names.
        url: The thread.
    """

    engine: str
    models: str
    functions: str
    url: str


_PINOCCHIO = "https://github.com/stack-of-tasks/pinocchio/issues/"
_ROBOTICSTOOLBOX = "https://github.com/petercorke/robotics-toolbox-python/issues/"
_DART = "https://github.com/dartsim/dart/"
THREADS = (
    # Shows it for JointModelSphericalZYX in a composite.
    Thread(
        "pinocchio", "euler|universal|ellipsoid|three hinges|offset|translation and", "coriolis", f"{_PINOCCHIO}2053"
    ),
    # Closed, for masses of fixed links; placements of fixed links before a joint are still left out of the recursion.
    Thread("roboticstoolbox", "fixed", "mass_matrix|gravity|bias|dynamics", f"{_ROBOTICSTOOLBOX}636"),
    # Mended integration for placed free joints; differences were left as they were.
    Thread("dart", "free", "difference", f"{_DART}pull/2298"),
)


def thread(engine: str, model: str, function: str) -> str:
    """The thread that knows a fault, or that none was found."""
    for row in THREADS:
        if row.engine == engine and re.search(row.models, model) and re.search(row.functions, function):
            return row.url
    return NONE
