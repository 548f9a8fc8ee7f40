"""What it takes to make each report, besides a compiler of C: what of it this machine lacks."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec

from symofros.tools import present as graphics_processor

from ..cuda import warp
from ..engines.plugins import OWN
from ..faults.environment import default_folder
from ..studies import studio


@dataclass(frozen=True)
class Needs:
    """What a report takes.

    Attributes:
        packages: Packages, as they are imported.
        programs: Programs.
        besides: What else is missing here, in words; "" for nothing.
    """

    packages: tuple[str, ...] = ()
    programs: tuple[str, ...] = ()
    besides: Callable[[], str] = str

    @property
    def missing(self) -> str:
        """What this machine lacks of it; "" for nothing."""
        return ", ".join(self._missing())

    def _missing(self) -> Iterator[str]:
        packages = [name for name in self.packages if find_spec(name) is None]
        yield from (f"package {name}" for name in packages)
        yield from (f"program {name}" for name in self.programs if shutil.which(name) is None)
        if not packages and (said := self.besides()):
            yield said


def _engines() -> str:
    absent = [name for name, plugin in OWN.items() if not plugin.version()]
    return f"engines {', '.join(absent)} (or parts measured elsewhere, --part)" if absent else ""


def _releases() -> str:
    return (
        ""
        if default_folder().is_dir()
        else "environments of releases: `recall` installs them, half an hour of downloads"
    )


def _processor() -> str:
    return "a graphics processor" if graphics_processor() is None else warp.missing()


_ENGINES = ("pinocchio", "mujoco", "exudyn", "casadi")
# By the names of reports; the others take none of it.
NEEDS: dict[str, Needs] = {
    "check": Needs(_ENGINES),
    "mutation": Needs(_ENGINES),
    "mutants": Needs((*_ENGINES, "pytest", "xdist")),
    "adversary": Needs(("hypothesis",)),
    "engines": Needs(besides=_engines),
    "recall": Needs(besides=_releases),
    "campaign": Needs((*_ENGINES, "pyarrow", "distributed")),
    "timing": Needs(_ENGINES, ("c++",)),
    "rollouts": Needs(("mujoco",)),
    "exports": Needs(programs=("octave-cli", "mkoctfile")),
    "environments": Needs(("jax", "torch", "casadi"), ("node", "clang")),
    "cuda": Needs(besides=_processor),
    "pareto": Needs(("mujoco", "exudyn")),
    "studio": Needs(("playwright", "pytest"), ("npm",), besides=studio.missing),
}
