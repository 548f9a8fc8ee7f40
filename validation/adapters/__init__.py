"""Adapters of engines: one folder each, which alone imports the engine's package; this module needs none.

Rigid trees and loops are stated to the engine's plug-in of the matrix (`charted`, `validation/engines`). Every plug-in
can be asked for by its name (`plugged`); an engine that takes part in every check, or that does more than plug-ins
state, has one folder here and one row of ROUTES. The folder's `__init__` imports without the engine's package, and
its DIFFERENCES state where conventions are not ours; its adapter has `build(subject) -> Engine | Unsupported`,
with methods named as the quantities it offers (`contract/quantities.py`). The steps: docs/architecture.md, "To add".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from typing import Literal

import symofros as sf

from ..contract.conventions import Difference
from ..contract.interface import EngineFactory, Format, Subject

# Which of our models of a description an engine is compared with; see `comparison.variants`.
Variant = Literal["as_described", "verbatim", "untruncated", "without_rotary"]


@dataclass(frozen=True)
class Missing:
    """An engine that does not import here.

    Attributes:
        reason: The import's error and the remedy.
    """

    reason: str


@dataclass(frozen=True)
class Route:
    """One way to a second opinion.

    Attributes:
        module: The adapter; `build` in it is the factory.
        package: Import name of the engine; "" for one that needs none.
        reads: Format of the files that the engine reads by itself; it has nothing to say of other models.
        independent: Whether it shares no equations with us, so that its agreement is evidence.
        beams: Whether it is asked for systems with beams only, and keeps all of their terms.
        rotary: Whether the sections of its beams have the rotary inertia of our theory; else it is compared without.
        loops: Whether it closes loops by itself; it is asked for systems with constraints only, at states that satisfy
            them.
        plugin: Name of the plug-in of the matrix that `build` is given first; "" for an adapter of its own.
    """

    module: str
    package: str = ""
    reads: Format = ""
    independent: bool = True
    beams: bool = False
    rotary: bool = True
    loops: bool = False
    plugin: str = ""

    @property
    def variant(self) -> Variant:
        """Our model that the engine is compared with."""
        if self.beams and not self.rotary:
            return "without_rotary"
        return "untruncated" if self.beams else "verbatim" if self.reads else "as_described"

    def applies_to(self, subject: Subject) -> bool:
        """Whether the engine is asked about a subject at all."""
        system = subject.system
        return (
            (not self.reads or self.reads == subject.format)
            and (not self.beams or has_beams(system))
            and (not self.loops or bool(system.constraints))
        )

    def load(self) -> EngineFactory | Missing:
        """The engine's factory; this imports its package and no other engine's."""
        try:
            build = import_module(self.module).build
        except ImportError as error:
            return Missing(f"{error}; pip install 'symofros[validation]'")
        factory: EngineFactory = partial(build, self.plugin) if self.plugin else build
        return factory


# In the order of reports. The generated C itself is not among them: it is what they are compared with.
ROUTES: dict[str, Route] = {
    "pinocchio": Route(f"{__name__}.pinocchio.tree", "pinocchio"),
    "mujoco": Route(f"{__name__}.mujoco.tree", "mujoco"),
    "exudyn": Route(f"{__name__}.exudyn.tree", "exudyn"),
    "pinocchio-loops": Route(f"{__name__}.pinocchio.loops", "pinocchio", loops=True),
    "exudyn-loops": Route(f"{__name__}.exudyn.loops", "exudyn", loops=True),
    "pinocchio-urdf": Route(f"{__name__}.pinocchio.urdf", "pinocchio", reads="urdf"),
    "mujoco-urdf": Route(f"{__name__}.mujoco.urdf", "mujoco", reads="urdf"),
    "mujoco-mjcf": Route(f"{__name__}.mujoco.mjcf", "mujoco", reads="mjcf"),
    "lagrangian": Route(f"{__name__}.lagrangian.engine", "casadi", beams=True),
    "exudyn-beams": Route(f"{__name__}.exudyn.mapped", "exudyn", beams=True, rotary=False),
    "vectors": Route(f"{__name__}.vectors", independent=False),
    "interpreted": Route(f"{__name__}.interpreted", independent=False),
    "description": Route(f"{__name__}.description", independent=False),
}


def route_of(name: str) -> Route:
    """The way to an engine: one of ROUTES, or any other plug-in of the matrix."""
    return ROUTES[name] if name in ROUTES else Route(f"{__name__}.plugged", plugin=name)


def in_order(names: Iterable[str]) -> list[str]:
    """Names of engines, each once, in the order of reports: of ROUTES, then as they come."""
    known = list(ROUTES)
    return sorted(dict.fromkeys(names), key=lambda name: known.index(name) if name in ROUTES else len(known))


def require_engines(names: Iterable[str]) -> None:
    """Refuse names of no engine; plug-ins are looked up only where there are names beyond ROUTES.

    Raises:
        LookupError: There is no such engine; the message names those that there are.
    """
    for name in set(names) - ROUTES.keys():
        others, failures = import_module(f"{__name__}.plugged").found()
        if name not in others:
            known = ", ".join(in_order([*ROUTES, *others]))
            why = "".join(f"; the plug-in '{other}' does not load: {reason}" for other, reason in failures.items())
            raise LookupError(f"no engine '{name}'; there are {known}{why}")


def factory_of(name: str, overrides: Mapping[str, EngineFactory | Missing] | None = None) -> EngineFactory | Missing:
    """How an engine's models are built, or why the engine does not import here.

    Args:
        name: Name of an engine.
        overrides: Factories that take the place of the adapters' own, by engine.
    """
    override = (overrides or {}).get(name)
    return route_of(name).load() if override is None else override


def differences() -> tuple[Difference, ...]:
    """Every difference of conventions, as the engines' folders state them; this imports no engine."""
    folders = dict.fromkeys(route.module.rpartition(".")[0] for route in ROUTES.values())
    return tuple(row for folder in folders if folder != __name__ for row in import_module(folder).DIFFERENCES)


def has_beams(system: sf.System) -> bool:
    """Whether any body is elastic."""
    return bool(system.beams)
