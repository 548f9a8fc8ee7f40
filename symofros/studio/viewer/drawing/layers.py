"""Layers of a drawing, which can be shown or hidden each: parts of the mechanism, and arrows of forces at one scale."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import UnknownNameError, did_you_mean
from symofros.studio.viewer.drawing.drawing import KINDS, Color, Drawing

# Layer -> its colour in pictures and its name in words, and the unit of what the arrows are.
ARROWS: dict[str, tuple[Color, str, str]] = {
    "forces": ((190, 0, 0), "red", "N"),
    "moments": ((0, 30, 220), "blue", "N m"),
}
# Of the mechanism's size: the longest arrow that a legend states, and the head, which an arrow is at least as long as.
_STATED, HEAD = 0.15, 1.0 / 40.0
SHAFT_RADIUS, HEAD_RADIUS = HEAD / 5.0, HEAD / 2.0  # Of the mechanism's size.
Arrows = Mapping[str, Array]
"""Layer -> tails and heads of its arrows in the world (K, 2, 3) [m], NaN of those that don't show."""


@dataclass(frozen=True)
class ArrowScale:
    """How long arrows are.

    Attributes:
        layer: Their layer.
        length: A round length [m] ...
        value: ... and the round force [N] or moment [N m] that an arrow of that length is.
        size: Extent of the mechanism [m].
    """

    layer: str
    length: float
    value: float
    size: float

    @classmethod
    def of(cls, layer: str, largest: float, size: float) -> ArrowScale | None:
        """A scale for arrows of up to some magnitude; None where there is nothing to draw."""
        if not (np.isfinite(largest) and largest > 0.0):
            return None
        return cls(layer, _round_below(_STATED * size), _round_below(largest), size)

    @property
    def smallest(self) -> float:
        """Magnitude below which there is no arrow: it would be shorter than its head."""
        return HEAD * self.size * self.value / self.length

    def arrows(self, points: Array, vectors: Array) -> Array:
        """Tails and heads (K, 2, 3) [m] of arrows from points (K, 3) [m] along vectors (K, 3); NaN where too short."""
        shown = np.linalg.norm(vectors, axis=-1) >= self.smallest  # False of what is not finite, too.
        ends = np.stack([points, points + vectors * (self.length / self.value)], axis=1)
        return np.where(shown[:, None, None], ends, np.nan)

    @property
    def legend(self) -> str:
        """The scale in words."""
        _, color, unit = ARROWS[self.layer]
        scale = f"{self.length:g} m is {self.value:g} {unit}"
        return f"{self.layer} ({color}): {scale}, none below {self.smallest:.2g} {unit}"


def _round_below(x: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above x."""
    power = 10.0 ** np.floor(np.log10(x))
    return float(f"{max(digit * power for digit in (1.0, 2.0, 5.0) if digit * power <= x):.1g}")


# What can be shown or hidden: kinds of pieces, and what is not of the mechanism itself.
LAYERS = (*KINDS, "frames", "labels", "ground", *ARROWS)


def initial_layers(drawing: Drawing) -> frozenset[str]:
    """The layers of a drawing that are shown initially: those that hide no others."""
    dressed, bare = ({part.link for part in drawing.parts if part.kind == kind} for kind in ("visuals", "bodies"))
    hidden = {"frames", "labels", *ARROWS}
    if dressed or not drawing.inertias_fit:
        hidden.add("inertias")
    if dressed and not bare - dressed and not drawing.beams:
        hidden |= {"bodies", "joints"}
    return frozenset(LAYERS) - hidden


def check_layer(what: str, layer: str) -> None:
    """Refuse a layer that there is none of.

    Args:
        what: What asks, such as "view".
        layer: Name of the layer.

    Raises:
        UnknownNameError: It is none of LAYERS.
    """
    if layer not in LAYERS:
        rule, remedy = f"one of {', '.join(LAYERS)}", did_you_mean(layer, LAYERS)
        raise UnknownNameError(f"{what}: no layer '{layer}'", f"'{layer}'", rule, remedy)
