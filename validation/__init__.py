"""Do independent engines agree with the generated code, how fast are they, and where do methods fail.

`check` is the door for programs; everything else is reached by the command line.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from symofros.harness import claim

if TYPE_CHECKING:
    import symofros as sf

    from .cross_check.result import CheckResult

claim(__name__)


def check(
    model: sf.System | str | Path,
    *,
    states: int = 1000,
    seed: int = 0,
    engines: Sequence[str] | None = None,
    floating_base: bool = False,
    full: bool = False,
) -> CheckResult:
    """Compare the generated code of one model with every engine that can represent it.

    Args:
        model: A system; or a URDF, MJCF, SDF, USD or YAML file, which engines of its format read themselves; or a name
            of the standard set.
        states: Number of random states.
        seed: Seed of the states.
        engines: Names of the engines to compare with, of plug-ins too; None: all that take part unasked.
        floating_base: Whether what stands on the ground goes onto a free joint; not of native files.
        full: Also ask what takes long on large models: every relation, and derivatives, whatever the number of speeds.

    Returns:
        What was compared. It is true if an independent engine was asked and everything agrees; printed, it is a table.

    Raises:
        DescriptionError: The model is no legal description.
        UnknownNameError: There is no such engine, or no such model.
        ArgumentError: There are no states to compare at.
    """
    # The engines take seconds to load: not before they are asked.
    result: CheckResult = import_module(".cross_check.result", __name__).check_model(
        model, states=states, seed=seed, engines=engines, floating_base=floating_base, full=full
    )
    return result
