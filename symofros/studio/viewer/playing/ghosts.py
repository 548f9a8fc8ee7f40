"""Other runs of a mechanism, shown transparent beside the one that plays, at the same times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.studio.viewer.drawing.drawing import Color, Drawing, same_geometry
from symofros.studio.viewer.drawing.poses import Mechanism, Posture
from symofros.studio.viewer.playing.motion import Played, PlayedMotion, motion_of

# Unlike each other to most eyes, before light grounds and dark ones.
_COLORS: tuple[Color, ...] = (
    (0, 158, 115),
    (213, 94, 0),
    (86, 180, 233),
    (204, 121, 167),
    (230, 159, 0),
    (0, 114, 178),
)
_LATE = 1e-9  # Of a motion's length, by which a time may miss its ends.


@dataclass(frozen=True)
class Ghost:
    """A run that is shown transparent.

    Attributes:
        name: Its name in the legend.
        color: Its color.
        motion: Its states.
        drawing: What is drawn of it; that of the mechanism where both look the same.
    """

    name: str
    color: Color
    motion: PlayedMotion
    drawing: Drawing

    def is_shown(self, t: Array) -> npt.NDArray[np.bool_]:
        """Whether it has a state at times (n) [s]: before its first and after its last it is not shown."""
        margin = _LATE * (self.motion.end - self.motion.start)
        shown: npt.NDArray[np.bool_] = (t >= self.motion.start - margin) & (t <= self.motion.end + margin)
        return shown

    def posture(self, mechanism: Mechanism, t: Array, exaggeration: float) -> Posture:
        """Postures of the ghost at times (n) [s]."""
        q, u, par = self.motion.at(t)
        return mechanism.posture(q, u, par[0], exaggeration)


def ghosts_of(mechanism: Mechanism, runs: Mapping[str, Played], drawing: Drawing) -> tuple[Ghost, ...]:
    """Runs by their names as ghosts of a mechanism.

    Raises:
        ShapeError: A run does not fit the model.
        SymofrosError: There are more than colors, or events change in a run how the mechanism looks.
    """
    if len(runs) > len(_COLORS):
        found, rule = f"{len(runs)} runs", f"{len(_COLORS)} ghosts at most: more can't be distinguished"
        raise SymofrosError("view: too many ghosts", found, rule, "show those that differ most")
    return tuple(
        _ghost(mechanism, name, motion_of(mechanism.model, run), color, drawing)
        for (name, run), color in zip(runs.items(), _COLORS, strict=False)
    )


def _ghost(mechanism: Mechanism, name: str, motion: PlayedMotion, color: Color, drawing: Drawing) -> Ghost:
    own, *others = (mechanism.drawing(par) for par in np.unique(motion.par, axis=0))
    if not all(same_geometry(own, other) for other in others):
        found, rule = "parameters that events set", "a ghost looks the same in all of its run"
        raise SymofrosError(f"view: ghost '{name}' changes its shape", found, rule, "play that run itself")
    return Ghost(name, color, motion, drawing if same_geometry(own, drawing) else own)
