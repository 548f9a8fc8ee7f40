"""Theories of beams as reductions of one another: of second order, in segments, geometrically exact."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any, get_args

from symofros.description import PRE_STRAINS, Beam, Direction, System
from symofros.runtime.beams import BeamBending, slope_error
from symofros.studio.advice.candidates import Reduction, changed_beam
from symofros.studio.advice.loads import BeamLoads

# Numbers of beams in series that a rod may be replaced by.
_SEGMENTS = (2, 4)
# Families of strain functions; those of displacements become Legendre's, which span the same curvatures or more.
_STRAIN_FAMILIES = ("spline", "polynomial", "legendre")


def as_rods(system: System, names: Iterable[str], start: Mapping[str, float]) -> System:
    """The system with some beams as geometrically exact rods.

    Args:
        system: System.
        names: Names of the beams.
        start: First coordinates by name; beams whose elastic coordinates are among them stay, as those of rods are
            others.
    """
    chosen = frozenset(names)
    beams = (beam for beam in system.beams if beam.name in chosen and not beam.elastic.is_exact)
    return system.with_bodies(
        *(
            replace(
                beam,
                theory="strain",
                family=beam.family if beam.family in _STRAIN_FAMILIES else "legendre",
                shapes=(),
                retain="first_order",
                foreshortening=True,
            )
            for beam in beams
            if not any(name.removeprefix("d") in beam.coordinates for name in start)
        )
    )


def missed_by_theory(loads: BeamLoads, bending: BeamBending) -> float:
    """Error of outputs due to second-order theory, in units of the tolerance."""
    return bending.error * loads.tip * loads.gain


def simpler_theories(loads: BeamLoads, rod: Beam, bending: BeamBending) -> Iterator[Reduction]:
    """Beams of second order in place of a rod, whole and in segments, and segments of the rod of fewer functions.

    Beams of second order are none where they lack what the rod has.
    """
    error = slope_error(bending.slope**2)
    body_loads = any(load.axes == "body" for load in rod.loads)  # Segments have no axes of the undeformed beam.
    divided = () if body_loads or rod.segments > 1 else _SEGMENTS
    fewer = {n: {label: -(-getattr(rod, label) // n) for label in get_args(Direction)} for n in divided}
    stated: list[tuple[str, dict[str, Any], float]] = []
    if not _is_beyond_second_order(rod):
        plain: dict[str, Any] = {"theory": "second_order", "sections": 0}
        stated += [
            ("second order, first_order", plain, error),
            ("second order, all", plain | {"retain": "all"}, error),
        ]
        for n in divided:
            segments = plain | {"segments": n}
            stated += [
                (f"{n} segments of second order", segments, error / n**2),
                (f"{n} segments of second order, {_shown(fewer[n])}", segments | fewer[n], error / n**2),
            ]
    if rod.family != "user":
        stated += [
            (f"{n} segments of it, {_shown(counts)}", counts | {"segments": n}, 0.0) for n, counts in fewer.items()
        ]
    for change, changed, share in stated:
        reason = f"it turns its sections by {bending.slope:.2g} rad"
        if share:
            reason += f", of which second order misses {100 * share:.2g} %"
        yield Reduction(
            f"beam '{rod.name}'",
            change,
            "theory",
            share * loads.tip * loads.gain,
            reason,
            changed_beam(rod.name, **changed),
            {"slope": bending.slope, "error": share},
        )


def _is_beyond_second_order(rod: Beam) -> bool:
    """Whether a rod has features that beams of second order lack."""
    beyond = any(getattr(rod, label) for label in ("stretch", "shear_y", "shear_z"))
    curved = any(getattr(rod, label) != 0.0 for label in PRE_STRAINS)
    return beyond or curved or rod.is_coupled or rod.family == "user"


def _shown(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{label} {n}" for label, n in counts.items() if n)
