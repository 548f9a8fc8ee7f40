"""What a beam's section brings, and the natural frequencies that follow from it, for the beam's window."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite, pi, prod, sqrt
from typing import Any

from pydantic import ValidationError

from symofros.description import CENTERS, ELASTIC, Value
from symofros.description.yaml import BeamEntry
from symofros.errors import DescriptionError
from symofros.expr import Expression, evaluate
from symofros.runtime.beams import BEAM_LIMIT, NOTED_ERROR, slope_of_error
from symofros.studio.editor.editing.data_edits import EditError

Json = dict[str, Any]

# Roots of 1 + cos(b) cosh(b) = 0: bending of a uniform cantilever (Blevins, Formulas for Natural Frequency, table 8-1).
_BENDING = (1.875104068711961, 4.694091132974174, 7.854757438237612)
# Of twist and stretch: odd quarters of a wave.
_QUARTERS = (pi / 2, 3 * pi / 2, 5 * pi / 2)
# Errors of the theory whose deflections are shown.
_ERRORS = (NOTED_ERROR, 0.1, BEAM_LIMIT)
_SHOWN = ("rhoA", "EI_y", "EI_z", "GJ", "EA", "rhoJ")
# Direction -> stiffness, inertia per length, roots, power of root/length in the angular frequency.
_MOTIONS = {
    "bend_y": ("EI_z", "rhoA", _BENDING, 2),
    "bend_z": ("EI_y", "rhoA", _BENDING, 2),
    "twist": ("GJ", "rhoJ", _QUARTERS, 1),
    "stretch": ("EA", "rhoA", _QUARTERS, 1),
}


def beam_figures(entry: Any, known: Mapping[str, float]) -> Json:
    """Figures of a beam at the parameters' defaults.

    Returns:
        `section`: property -> number, without those that vary along the beam or have none; `frequencies`: direction ->
        the first three of the uniform slender beam, clamped at its root and free at its tip [Hz], without those
        beyond the range of numbers; none where the section couples directions. Rotary inertia, shear, gravity and loads
        are left out. `validity`: errors of second-order theory relative to the deflection, each with the slope of the
        tip [rad] and its deflection under a force there [m] that go with it (docs/theory/beams.md, (24)); none of a
        geometrically exact rod, or without a length.

    Raises:
        EditError: The entry is no beam yet.
    """
    try:
        stated = BeamEntry.model_validate(entry).stated()
    except (ValidationError, DescriptionError) as error:
        rule = "figures are of a beam that can be read"
        raise EditError("the beam is not complete", f"{str(error)[:100]}", rule, "fill in what is marked") from None
    numbers = {name: _number(stated.get(name), known) for name in (*_SHOWN, "length")}
    figures = {name: number for name, number in numbers.items() if number is not None}
    if figures.get("rhoJ") == 0.0:  # Not stated: twist without inertia of its own.
        del figures["rhoJ"]
    length = figures.pop("length", 0.0)
    is_plain = not _couples_directions(stated)
    frequencies = {
        direction: _hertz(figures[stiffness] / figures[inertia], [root / length for root in roots], power)
        for direction, (stiffness, inertia, roots, power) in _MOTIONS.items()
        if is_plain and length > 0.0 and figures.get(stiffness, 0.0) > 0.0 and figures.get(inertia, 0.0) > 0.0
    }
    finite = {direction: values for direction, values in frequencies.items() if all(map(isfinite, values))}
    errs = not ELASTIC[stated["theory"]].is_exact and length > 0.0
    return {
        "section": figures,
        "frequencies": finite,
        "validity": [_validity(error, length) for error in _ERRORS if errs],
    }


def _couples_directions(stated: Json) -> bool:
    """Whether bending, twist and stretch do not vibrate by themselves."""
    off_axis = [stated.get(label) for label in ("EI_yz", "rhoI_yz")]
    off_axis += [value for label in CENTERS for value in stated.get(label) or ()]
    return bool(stated.get("stiffness")) or any(value not in (None, 0.0) for value in off_axis)


def _validity(error: float, length: float) -> Json:
    """How far a cantilever may bend for an error; a force at the tip deflects it by 2/3 of slope times length."""
    slope = slope_of_error(error)
    return {"error": error, "slope": slope, "deflection": 2.0 / 3.0 * slope * length}


def _hertz(ratio: float, wave_numbers: list[float], power: int) -> list[float]:
    """Natural frequencies by stiffness over inertia; products, which overflow to infinity where powers raise."""
    return [prod([number] * power) * sqrt(ratio) / (2 * pi) for number in wave_numbers]


def _number(value: Value | None, known: Mapping[str, float]) -> float | None:
    """The number of a property; None where it has none, or varies along the beam."""
    if value is None:
        return None
    try:
        number = evaluate(value if isinstance(value, Expression) else float(value), known)
    except (KeyError, ArithmeticError):
        return None
    return number if isfinite(number) else None
