"""The engines: one room each, and no other room imports the engine's package; here, what needs none."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module

from validation.contract.interface import EngineFactory, Format


@dataclass(frozen=True)
class Route:
    """One way to a second opinion.

    Attributes:
        module: The adapter; its `build` is the factory.
        reads: It reads files of this format by itself, and has nothing to say of other models.
        independent: It shares no equations with us; agreement with it is evidence.
        beams: It is asked for systems with beams only, and compared with our model that keeps all their terms.
        loops: It closes loops by itself; it is asked for systems with constraints only, at states that keep them.
    """

    module: str
    reads: Format = ""
    independent: bool = True
    beams: bool = False
    loops: bool = False


# In the order of reports. The generated C itself is not among them: it is what they are compared with.
ROUTES: dict[str, Route] = {
    "pinocchio": Route("validation.adapters.pinocchio.tree"),
    "mujoco": Route("validation.adapters.mujoco.tree"),
    "pinocchio-loops": Route("validation.adapters.pinocchio.loops", loops=True),
    "exudyn-loops": Route("validation.adapters.exudyn.loops", loops=True),
    "pinocchio-urdf": Route("validation.adapters.pinocchio.urdf", reads="urdf"),
    "mujoco-urdf": Route("validation.adapters.mujoco.urdf", reads="urdf"),
    "mujoco-mjcf": Route("validation.adapters.mujoco.mjcf", reads="mjcf"),
    "lagrangian": Route("validation.adapters.lagrangian.engine", beams=True),
    "interpreted": Route("validation.adapters.interpreted", independent=False),
    "description": Route("validation.adapters.description", independent=False),
}


@dataclass(frozen=True)
class Missing:
    """An engine that does not import here.

    Attributes:
        reason: Why not, and the remedy.
    """

    reason: str


@cache
def available() -> dict[str, EngineFactory | Missing]:
    """Every engine by name: how to build its models, or why it does not import here."""
    return {name: _factory(route) for name, route in ROUTES.items()}


def _factory(route: Route) -> EngineFactory | Missing:
    try:
        factory: EngineFactory = import_module(route.module).build
    except ImportError as error:
        return Missing(f"{error}; pip install 'symofros[validation]'")
    return factory
