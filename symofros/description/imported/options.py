"""Options of reading that mean the same for every foreign format: URDF (with xacro), MJCF, SDFormat and USD."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from symofros.errors import ArgumentError, did_you_mean

Dissipation = Literal["none", "viscous", "all", "stiction"]
LimitsAs = Literal["data", "stops"]
# Rounding of the last printed digit of a double: snapping by default must not change a model by more than that, because
# imports are compared with other engines' at 1e-12. Who knows that a file's 1.5708 means pi/2 passes 1e-4.
SNAP_TOL = 1e-14


@dataclass(frozen=True)
class ImportOptions:
    """How a foreign file is read.

    Attributes:
        floating_base: Whether the body that stands on the ground goes onto a free joint; one that floats stays so.
        snap_tol: Numbers this close to exact ones are made exact: positions to 0 [m]; entries of axes and rotations to
            0 and +-1, or angles to multiples of pi/2 [rad].
        mimic: Whether joints that mimic others are coupled to them; of URDF, other formats always couple them.
        dissipation: What of the file's passive losses is kept: "none"; "viscous", its dampers; "all", dry friction
            too, as smoothed Coulomb friction; "stiction", dry friction that holds joints at rest. None: what the
            format keeps by default.
        limits: What limits of coordinates are: "data", or "stops" that push back.
    """

    floating_base: bool = False
    snap_tol: float = SNAP_TOL
    mimic: bool = False
    dissipation: Dissipation | None = None
    limits: LimitsAs = "data"

    def __post_init__(self) -> None:
        """Refuse unknown choices, and a `snap_tol` that is not small.

        Raises:
            ArgumentError: A word is unknown, or `snap_tol` is not a small number.
        """
        if not 0.0 <= self.snap_tol < 0.1:
            rule = "0 <= snap_tol < 0.1, so that it absorbs rounding only"
            raise ArgumentError("snap_tol is not a small number", str(self.snap_tol), rule, "leave it out")
        for name, words in (("dissipation", get_args(Dissipation)), ("limits", get_args(LimitsAs))):
            word = getattr(self, name)
            if word is not None and word not in words:
                rule, remedy = f"one of {', '.join(words)}", did_you_mean(str(word), words)
                raise ArgumentError(f"{name}: unknown choice", f"'{word!s:.40}'", rule, remedy)


DEFAULT_OPTIONS = ImportOptions()
