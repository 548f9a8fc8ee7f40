"""Noise in every number of a description, as files have it that programs wrote, rounded or measured.

A reader's own rounding, products in single precision and few printed digits all move numbers by 1e-16 to 1e-6 of their
size, zeros included. What a model says must move by no more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

import symofros as sf

# Directions, which may be of any length.
_DIRECTIONS = {"axis", "axis2"}
# Numbers whose zeros are moved, too; elsewhere a zero says that there is none of something.
_MOVED_ZEROS = {"position", "center_of_mass", "moments", *_DIRECTIONS}
# What the tool must do with them is not what noise is about: places in time, and where a beam is divided.
_LEFT = {"stations", "at", "limits", "gravity", "visuals", "origin"}
# Largest noise of a matrix, entry by entry: |R R^T - 1| stays below the 1e-6 that is refused.
_OF_A_MATRIX = 2e-7


def with_noise(system: sf.System, seed: int, size: float | None = None) -> sf.System:
    """A system whose numbers have noise, whose rotations have other forms and whose axes have other lengths.

    Args:
        system: System; numbers in formulas stay as they are, values of parameters don't.
        seed: Of every choice.
        size: Of the noise, relative to a number or a vector; drawn from 1e-16 to 1e-6 for each of them if not given.
    """
    rng = np.random.default_rng(seed)

    def noise(shape: tuple[int, ...] = (), most: float = 1e-6) -> Any:
        one = 10.0 ** rng.uniform(-16, -6) if size is None else size
        return min(one, most) * rng.uniform(-1, 1, shape) * (rng.random(shape) < 0.7)

    noisy: sf.System = _Noisy(rng, noise).of(system)
    return noisy


class _Noisy:
    """Restates what it is given.

    Args:
        rng: Choices.
        noise: Draws noise of a shape and at most a size, relative to one.
    """

    def __init__(self, rng: np.random.Generator, noise: Callable[..., Any]) -> None:
        self._rng, self._noise = rng, noise

    def of(self, stated: Any, name: str = "") -> Any:
        """An entry of a description.

        Args:
            stated: Value, sequence or part.
            name: Name of its field.
        """
        if name in _LEFT:
            return stated
        if isinstance(stated, sf.Rotation):
            return self._rotation(stated)
        if isinstance(stated, sf.Beam):  # Its frames are places on its axis, its shapes functions.
            return replace(self._part(stated), frames=stated.frames, shapes=stated.shapes)
        if isinstance(stated, sf.Inertia) and stated.about == "body":  # Along the axes of the body, by definition.
            moved = {key: self.of(getattr(stated, key), key) for key in ("mass", "center_of_mass", "moments")}
            return replace(stated, **moved)
        if is_dataclass(stated) and not isinstance(stated, type | sf.Expression):
            return self._part(stated)
        if isinstance(stated, tuple) and stated and all(isinstance(x, float) for x in stated):
            return self._vector(np.array(stated), name)
        if isinstance(stated, tuple):
            return tuple(self.of(x, name) for x in stated)
        return stated * (1.0 + float(self._noise())) if isinstance(stated, float) else stated

    def _part(self, stated: Any) -> Any:
        """A part of a description, entry by entry."""
        changed = {item.name: self.of(getattr(stated, item.name), item.name) for item in fields(stated) if item.init}
        return replace(stated, **changed)

    def _vector(self, stated: np.ndarray, name: str) -> tuple[float, ...]:
        scale = np.abs(stated).max() if name in _MOVED_ZEROS else np.abs(stated)
        if name == "position":
            scale = max(float(scale), 1.0)
        length = 10.0 ** self._rng.integers(-3, 4) if name in _DIRECTIONS else 1.0
        return tuple(map(float, length * (stated + scale * self._noise(stated.shape))))

    def _rotation(self, stated: sf.Rotation) -> sf.Rotation:
        """In another form where it is none at all, with noise, and with directions of another length."""
        if not all(isinstance(x, float) for x in stated.values):
            return stated
        kind, values = stated.kind, np.array(stated.values, float)
        if stated.is_identity:
            kind, none = list(_NONE.items())[self._rng.integers(len(_NONE))]
            values = np.array(none)
        values = values + self._noise(values.shape, _OF_A_MATRIX if kind == "matrix" else 1e-6)
        directed = {"quaternion": 4, "axis_angle": 3}.get(kind, 0)
        values[:directed] *= 10.0 ** self._rng.integers(-3, 4)
        return replace(stated, kind=kind, values=tuple(map(float, values)))


# Ways to state that nothing turns.
_NONE: dict[Any, tuple[float, ...]] = {
    "rpy": (0.0, 0.0, 0.0),
    "axis_angle": (0.0, 0.0, 1.0, 0.0),
    "quaternion": (0.0, 0.0, 0.0, -1.0),
    "matrix": (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
}
