"""The scenes, in the order of the report."""

from __future__ import annotations

from validation.pareto import spin_up
from validation.pareto.scene import Scene

SCENES: dict[str, Scene] = {
    "spin_up": spin_up.SCENE,
}
