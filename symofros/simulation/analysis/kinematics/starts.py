"""First states as somebody states them, some coordinates and speeds by name, brought onto the constraints."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.names import coordinate_of, speed_of
from symofros.errors import AssemblyError
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.assembly import assemble
from symofros.simulation.analysis.kinematics.nearest_start import Instant, nearest_posture_to, nearest_speeds_to
from symofros.simulation.settings import CLOSED

# Relative change of a stated number that counts as digits which were not typed; beyond, or of a zero that becomes more
# than what drift leaves, the start is another one than was asked for.
DIGITS = 1e-3
# Share of the strongest combination of conditions below which one counts as repeating others: the closure leaves half
# of its digits in a singular posture. It grows as the way from there [rad, m].
WEAK, _BESIDE = 1e-5, 0.03


class ClosedStart(NamedTuple):
    """A first state on the constraints.

    Attributes:
        q: Configuration (nq).
        v: Speeds (nv).
        notes: What was stated and changed in its last digits, in words.
    """

    q: Array
    v: Array
    notes: tuple[str, ...] = ()


def stated_names(
    q_names: Sequence[str], v_names: Sequence[str], labels: Collection[str]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Coordinates that labels state, and speeds, these also as rates of their coordinates; others are left out."""
    coordinates = {label: coordinate_of(label, q_names) for label in labels}
    speeds = (speed_of(label, v_names) for label, coordinate in coordinates.items() if not coordinate)
    return tuple(filter(None, coordinates.values())), tuple(filter(None, speeds))


def closed_start(
    model: Model,
    q: Array,
    v: Array,
    coordinates: Collection[str],
    speeds: Collection[str],
    *,
    u: ArrayLike | None = None,
    par: ArrayLike | None = None,
    t: float = 0.0,
) -> ClosedStart:
    """The state on the constraints near a guess that keeps what was stated of it.

    Args:
        model: Model; one without constraints keeps the state as it is.
        q: Guess (nq).
        v: Wished speeds (nv).
        coordinates: Names of the coordinates (`model.names.q`) that are stated.
        speeds: Names of the speeds (`model.names.v`) that are stated.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
        t: Time.

    Raises:
        AssemblyError: No state on the constraints keeps what is stated; says by how much the nearest one that is found
            differs. Or there is none at all.
        ShapeError: A quaternion is no rotation.
    """
    q = at_unit_length(model.record, "q", q, "the start")
    if not model.nc:
        return ClosedStart(q, v)

    at = Instant(model, u, par, t)
    on = _posture(at, q, coordinates)
    moving = _speeds(at, on, v, speeds)
    names, stated = (model.names.q, model.names.v), (coordinates, speeds)
    return ClosedStart(on, moving, changes(model.record.name, names, stated, (q, v), (on, moving)))


def singular_start(model: Model, q: Array) -> tuple[str, ...]:
    """A note where the constraints have less rank at a first posture than beside it; none where they have not.

    Args:
        model: Model; one without constraints has no singular posture.
        q: Configuration (nq) on the constraints.
    """
    if not model.nc or not model.nv:
        return ()
    strengths = np.linalg.svd(model.constraint_jacobian(q))
    weak = strengths.Vh[np.append(strengths.S, np.zeros(model.nv - len(strengths.S))) <= WEAK * strengths.S[0]]
    ranks = [_rank(strengths.S)]
    for way in (*weak, *-weak):  # What the constraints leave free here, and more of it beside a singular posture.
        with suppress(AssemblyError):
            beside = assemble(model, model.integrate(q, _BESIDE * way)).q
            ranks.append(_rank(np.linalg.svd(model.constraint_jacobian(beside)).S))
    if max(ranks) == ranks[0]:
        return ()
    return (
        f"the start is a singular posture: the constraints' rank is {ranks[0]} there and {max(ranks)} beside it;"
        " which way the mechanism leaves it is left to rounding: start beside it",
    )


def _rank(strengths: Array) -> int:
    """Number of singular values that are not weak."""
    return int((strengths > WEAK * strengths.max(initial=0.0)).sum())


def _posture(at: Instant, q: Array, coordinates: Collection[str]) -> Array:
    """The closed posture (nq) that keeps the stated coordinates, or the nearest to them that is found."""
    choices = _holding(at.model, coordinates)
    if not choices[0]:
        return at.assembled(q).q

    def accepted(found: Array) -> bool:
        return _are_digits(_changed(at.model.names.q, coordinates, q, found))

    for held in filter(None, choices):
        with suppress(AssemblyError):
            found = at.assembled(q, held=held).q
            if accepted(found):
                return found
    return nearest_posture_to(at, q, choices[0], accepted)


def _speeds(at: Instant, q: Array, v: Array, speeds: Collection[str]) -> Array:
    """The speeds (nv) that keep the stated ones, or the nearest to them."""
    held = tuple(speeds)
    with suppress(AssemblyError):
        return at.assembled(q, v, held).v
    names = at.model.names.v
    return nearest_speeds_to(at, q, v, held, lambda found: _are_digits(_changed(names, speeds, v, found)))


def _holding(model: Model, coordinates: Collection[str]) -> tuple[tuple[str, ...], ...]:
    """Speeds to hold so that coordinates stay, first choice first.

    An entry of a quaternion can't be held alone: its whole rotation is, and of a pose all translations.
    """
    linear: list[str] = []
    others: list[str] = []
    for segment in model.record.segments:
        ends = (segment.q, segment.q + segment.translations, segment.q + segment.size)
        speeds = model.names.v[segment.v : segment.v + segment.speeds]
        stated = [i for i in range(ends[0], ends[2]) if model.names.q[i] in coordinates]
        if segment.kind == "linear":
            linear += [speeds[i - segment.q] for i in stated]
            continue
        if any(i < ends[1] for i in stated):
            others += speeds[: segment.translations]
        if any(i >= ends[1] for i in stated):
            others += speeds[segment.translations :]
    return tuple(dict.fromkeys([(*linear, *others), tuple(linear)]))


def _changed(
    known: Sequence[str], stated: Collection[str], asked: Array, found: Array
) -> dict[str, tuple[float, float]]:
    """Stated numbers that changed by more than what drift leaves, with what they became."""
    pairs = {name: (float(asked[known.index(name)]), float(found[known.index(name)])) for name in stated}
    return {name: (old, new) for name, (old, new) in pairs.items() if abs(new - old) > CLOSED * max(1.0, abs(old))}


def _are_digits(changed: Mapping[str, tuple[float, float]]) -> bool:
    """Whether stated numbers changed in their last digits alone."""
    return all(abs(new - old) <= DIGITS * abs(old) for old, new in changed.values())


def changes(
    model: str,
    names: tuple[Sequence[str], Sequence[str]],
    stated: tuple[Collection[str], Collection[str]],
    asked: tuple[Array, Array],
    found: tuple[Array, Array],
) -> tuple[str, ...]:
    """Notes on stated values of a start that changed in their last digits.

    Args:
        model: Name of the model.
        names: Names of its coordinates, and of its speeds.
        stated: Those that are stated.
        asked: q (nq) and v (nv) as they are stated.
        found: q and v on the constraints.

    Raises:
        AssemblyError: More than those digits changed.
    """
    changed = {
        mark + name: pair
        for mark, known, those, old, new in zip(("", "d"), names, stated, asked, found, strict=True)
        for name, pair in _changed(known, those, old, new).items()
    }
    if not changed:
        return ()
    if _are_digits(changed):
        return tuple(
            f"start: {name} = {old:g} was taken as {_shown(new)}, which meets the constraints"
            for name, (old, new) in changed.items()
        )
    found_words = (
        f"{name} = {old:g} would be {_shown(new)}, {abs(new - old):.3g} off" for name, (old, new) in changed.items()
    )
    raise AssemblyError(
        f"model '{model}': the stated start does not meet the constraints",
        "nearest found: " + "; ".join(found_words),
        "what is stated of a start is kept; what is not follows from the constraints",
        "leave out what shall follow, or state what is near: "
        + ", ".join(f"{name} = {_shown(new)}" for name, (_, new) in changed.items()),
    )


def _shown(number: float) -> str:
    return f"{round(number, 9) + 0.0:.9g}"
