"""Reference models by name, each with its source: `MODELS["rx90"]` is a System.

Files are read, and mechanisms built, when they are first asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path

import symofros as sf
from symofros.harness import claim

from .closed import spatial
from .closed.four_bars import n_four_bar
from .closed.two_arms import two_arms
from .flexible.arm import flexible_arm
from .flexible.station import flexible_mss
from .rigid.chain import chain
from .rigid.random_tree import KINDS, SERIES_KINDS, random_tree
from .rigid.station import mss, spdm, ssrms

claim(__name__)
_FOLDER = Path(__file__).parent

_BUILT: dict[str, Callable[[], sf.System]] = {
    "chain7": lambda: chain(7),
    "chain22": lambda: chain(22),
    "ssrms": ssrms,
    "spdm": spdm,
    "mss": mss,
    "flexible_arm": flexible_arm,
    "flexible_mss": flexible_mss,
    "bricard": spatial.bricard,
    "stewart": spatial.stewart,
    "delta": spatial.delta,
    "delta_rods": lambda: spatial.delta(rod_mass=0.08),
    "two_four_bars": lambda: n_four_bar(2),
    "grasp": spatial.grasp,
    "two_arms": two_arms,
    "random_tree1": lambda: random_tree(1, 12),
    "random_tree4": lambda: random_tree(4, 12, ("revolute", "revolute", "prismatic", "fixed")),
    "random_tree70": lambda: random_tree(70, 12, (*KINDS, *SERIES_KINDS)),
}


class _Models(Mapping[str, sf.System]):
    """Name -> System, for the YAML files of the folder and for what is built in Python."""

    def __getitem__(self, name: str) -> sf.System:
        if name not in self._sources():
            raise KeyError(name)
        return load_model(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._sources())

    def __len__(self) -> int:
        return len(self._sources())

    @staticmethod
    @cache
    def _sources() -> tuple[str, ...]:
        return (*(path.stem for path in sorted(_FOLDER.glob("*/*.yaml"))), *_BUILT)


@cache
def load_model(name: str) -> sf.System:
    """The reference model of that name.

    Raises:
        KeyError: There is none.
    """
    if name in _BUILT:
        return _BUILT[name]()
    (path,) = _FOLDER.glob(f"*/{name}.yaml")
    return sf.load(path)


MODELS: Mapping[str, sf.System] = _Models()
