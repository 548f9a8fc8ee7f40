"""The scenes of the atlas, in its order."""

from __future__ import annotations

from validation.stability import baumgarte
from validation.stability.scene import Scene

SCENES: dict[str, Scene] = {
    "baumgarte": baumgarte.SCENE,
}
