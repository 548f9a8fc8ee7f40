"""The errors between two engines' results, and the verdict."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from ..contract.interface import Engine, States
from ..contract.quantities import QUANTITIES, SMALL, Quantity
from ..contract.raised import Raised
from ..mechanics.geometry import Array

Status = Literal["agree", "disagree", "unsupported", "failed"]

# Decades of relative error in which states are counted: 1e-18 … 1e0, four bins each; exact agreement comes before.
BINS_PER_DECADE = 4
LOWEST_DECADE, HIGHEST_DECADE = -18, 0
BIN_EDGES = tuple(
    10.0 ** (k / BINS_PER_DECADE) for k in range(LOWEST_DECADE * BINS_PER_DECADE, HIGHEST_DECADE * BINS_PER_DECADE + 1)
)
# Engine of a row that says that no independent engine could be asked.
NOBODY = "any"


@dataclass(frozen=True)
class Comparison:
    """One quantity of one model, by us and by one engine.

    Attributes:
        model: Label of the model.
        engine: Engine that our result is compared with.
        quantity: Quantity that is compared.
        status: The verdict; "unsupported" counts neither way.
        states: Number of states that were compared.
        error: The largest over the states; None if there is none or it is not a number.
        tolerance: Bound that the error must not exceed.
        median: Median of the errors.
        worst_state: Index of the state with the largest error.
        counts: States in each bin of BIN_EDGES, those that agree exactly first and those beyond the last edge last.
        note: The reason of what is unsupported or failed; else a remark.
        extra: Further figures, by name.
        scale: Scale that the largest error is relative to, in the unit of the quantity.
    """

    model: str
    engine: str
    quantity: str
    status: Status
    states: int = 0
    error: float | None = None
    tolerance: float = 0.0
    median: float | None = None
    worst_state: int | None = None
    counts: tuple[int, ...] = ()
    note: str = ""
    extra: dict[str, float] = field(default_factory=dict)
    scale: float | None = None

    @property
    def ok(self) -> bool:
        """Whether this row is no reason for concern."""
        return self.status in ("agree", "unsupported")

    @property
    def unconfirmed(self) -> bool:
        """Whether it says that no independent engine could be asked about the model."""
        return self.engine == NOBODY

    @property
    def title(self) -> str:
        """The quantity, for people."""
        return self.quantity.replace("_", " ")


def raised(model: str, engine: str, quantity: str, fault: Raised) -> Comparison:
    """Row of an exception in an engine's adapter or in our own model: failed, which never counts as agreement."""
    return Comparison(model, engine, quantity, "failed", note=f"raises {fault.words}")


@dataclass(frozen=True)
class Scales:
    """Typical sizes on one model, from which the scales of vanishing quantities are taken.

    Attributes:
        inertia: Median over the states of the largest entry of M.
        energy: Median kinetic energy [J].
    """

    inertia: float
    energy: float


def compute(engine: Engine, quantity: Quantity, states: States) -> Array:
    """An engine's results for a quantity (N, ...)."""
    asked = states.at_rest() if quantity.at_rest else states
    result: Array = getattr(engine, quantity.method or quantity.name)(asked)
    return result


def typical_scales(engine: Engine, states: States) -> Scales:
    """Typical sizes of M and T.

    They are taken from our own model: if its M were wrong, the comparison of M itself would say so.
    """
    M = compute(engine, QUANTITIES["mass_matrix"], states)
    T = compute(engine, QUANTITIES["kinetic_energy"], states)
    return Scales(float(np.median(np.abs(M).max(axis=(1, 2)))), float(np.median(T)))


def state_errors(quantity: Quantity, value: Array, reference: Array, scales: Scales) -> Array:
    """The error of each state (N,): of its worst frame, relative to the largest entry of the reference.

    Raises:
        ValueError: The two do not have the same shape.
    """
    return scaled_errors(quantity, value, reference, scales)[0]


def scaled_errors(quantity: Quantity, value: Array, reference: Array, scales: Scales) -> tuple[Array, Array]:
    """The error of each state (N,), and what it is relative to (N,).

    Raises:
        ValueError: The two do not have the same shape.
    """
    if value.shape != reference.shape:
        raise ValueError(f"{quantity.name}: shape {value.shape} against {reference.shape}")
    size = _largest(np.abs(reference), quantity.axes)
    difference = _largest(np.abs(value - reference), quantity.axes)
    sizes = np.maximum(size, _floor(quantity, size, scales)).reshape(len(size), -1)
    errors = difference.reshape(sizes.shape) / sizes
    worst = errors.argmax(axis=1)[:, None]  # The first NaN, where there is one.
    return np.take_along_axis(errors, worst, 1)[:, 0], np.take_along_axis(sizes, worst, 1)[:, 0]


def _largest(x: Array, axes: int) -> Array:
    return np.asarray(x.max(axis=tuple(range(-axes, 0)))) if axes else x


def _floor(quantity: Quantity, size: Array, scales: Scales) -> float:
    """Lower bound of the scale that errors are relative to; see `quantities.Floor`."""
    finite = size[np.isfinite(size)]
    if not finite.size:
        return 1.0
    typical = SMALL * float(np.median(finite))
    natural = {
        "none": 0.0,
        "inertia_force": SMALL * scales.inertia,
        "energy": max(float(finite.max()), SMALL * scales.energy),
        "unit": SMALL,
    }[quantity.floor]
    # Where all is exactly zero any scale will do: the error is then absolute.
    return max(typical, natural) or 1.0


def judge(
    model: str, engine: str, quantity: Quantity, errors: Array, note: str = "", sizes: Array | None = None
) -> Comparison:
    """The verdict over a batch of states; a NaN disagrees.

    Args:
        model: Label of the model.
        engine: Engine that our results were compared with.
        quantity: Quantity that was compared.
        errors: Errors of each state (N,).
        note: A remark.
        sizes: Scales that the errors are relative to (N,), if they are to be kept.
    """
    finite = bool(np.all(np.isfinite(errors)))
    worst = float(errors.max()) if finite else None
    agrees = worst is not None and worst <= quantity.tolerance
    at = int(np.argmax(np.where(np.isfinite(errors), errors, np.inf)))
    return Comparison(
        model,
        engine,
        quantity.name,
        "agree" if agrees else "disagree",
        len(errors),
        worst,
        quantity.tolerance,
        float(np.median(errors)) if finite else None,
        at,
        count(errors),
        note if finite else "not a finite number in some state",
        scale=None if sizes is None else float(sizes[at]),
    )


def count(errors: Array) -> tuple[int, ...]:
    """Number of states whose error falls into each bin; NaN goes to the last bin."""
    bins = np.digitize(np.where(np.isnan(errors), np.inf, errors), BIN_EDGES)
    return tuple(np.bincount(bins, minlength=len(BIN_EDGES) + 1).tolist())
