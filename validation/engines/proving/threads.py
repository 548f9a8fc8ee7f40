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
THREADS = (
    # Joints are to be added depth first, by a maintainer's answer; nothing refuses another order.
    Thread("pinocchio", "numbered across", "", f"{_PINOCCHIO}1897"),
    # Tensors of Eigen, stored by columns, are taken for NumPy's, stored by rows.
    Thread("pinocchio", "", "jacobian_dq", "https://github.com/stack-of-tasks/eigenpy/issues/557"),
    # Armature is the rotor inertia of actuators; a joint without one loses it.
    Thread("drake", "armature by default", "", "https://github.com/RobotLocomotion/drake/pull/21967"),
    # Shows it for JointModelSphericalZYX in a composite.
    Thread("pinocchio", "euler|universal|ellipsoid|hinges|slide|translation and", "coriolis", f"{_PINOCCHIO}2053"),
)


def thread(engine: str, model: str, function: str) -> str:
    """The thread that knows a fault, or that none was found."""
    for row in THREADS:
        if row.engine == engine and re.search(row.models, model) and re.search(row.functions, function):
            return row.url
    return NONE
