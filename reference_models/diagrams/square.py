"""The paper's square (reference_models/square.yaml), with other plants."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import symofros as sf
from symofros.diagrams.program.variants import with_functions

FILE = Path(__file__).parent.parent / "square.yaml"


def square(functions: int | None = None, robot: sf.System | None = None) -> sf.Diagram:
    """The diagram of the paper's figure 8.

    Args:
        functions: Shape functions of the plant's links; None: as described; 0: a rigid plant.
        robot: The plant, in place of the one described.
    """
    diagram = sf.load_diagram(FILE)
    plant = diagram.models["plant"]
    system = robot or plant.system
    if functions is not None:
        system = with_functions(system, functions)
    return diagram.with_model("plant", replace(plant, system=system))
