"""What is in the models that were compared: kinds of joints, loops, beams, springs, the format of their file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import symofros as sf

from ..checking import description_hash
from ..inputs.cases import Case, standard_set

# File suffix -> format; our own YAML and Python otherwise.
_FORMATS = {".urdf": "URDF", ".xml": "MJCF", ".sdf": "SDF", ".usda": "USD"}
# Kinds of constraints -> what people call them.
_LOOPS = {
    "Closure": "closed loop",
    "Rod": "loop closed by a massless rod",
    "Coupling": "coupling of coordinates",
    "Rolling": "rolling without slip",
    "KnifeEdge": "knife edge",
}


@dataclass(frozen=True)
class Features:
    """What a description has.

    Attributes:
        joints: Kinds of its joints, the most frequent first.
        parts: What else it has, with its number: closed loops, beams, springs and contacts.
        format: Format of its file; "YAML or Python" for ours.
    """

    joints: tuple[str, ...]
    parts: tuple[str, ...]
    format: str

    @property
    def said(self) -> str:
        """All of it in words."""
        return "; ".join(filter(None, (", ".join(self.parts), f"joints: {', '.join(self.joints)}", self.format)))


def features_of(hashes: Mapping[str, str]) -> dict[str, Features]:
    """What the models of a stored check have; only those that are here as they were compared.

    Args:
        hashes: Model -> hash of the description that was compared.
    """
    return {case.label: found for case, found in _read(hashes)}


def _read(hashes: Mapping[str, str]) -> Iterator[tuple[Case, Features]]:
    try:
        cases = standard_set()
    except FileNotFoundError:  # The package of robots is not installed.
        return
    for case in cases:
        if case.label not in hashes:
            continue
        try:
            system = case.load().system
        except (sf.SymofrosError, OSError):
            continue
        if description_hash(system) == hashes[case.label]:
            yield case, _features(system, case)


def _features(system: sf.System, case: Case) -> Features:
    kinds = Counter(body.joint.kind for body in system.bodies if body.joint is not None)
    counts = Counter(_LOOPS.get(type(one).__name__, type(one).__name__.lower()) for one in system.constraints)
    counts["beam"] = len(system.beams)
    counts |= Counter("contact" if isinstance(one, sf.Contact) else "spring or damper" for one in system.connections)
    parts = tuple(f"{number} {name}{'s' * (number > 1)}" for name, number in counts.items() if number)
    suffix = case.path.suffix if case.path else ""
    return Features(tuple(kind for kind, _ in kinds.most_common()), parts, _FORMATS.get(suffix, "YAML or Python"))
