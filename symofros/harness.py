"""Where the harness is, and what it is called: the only place in the package that names it.

A wheel installs it as `symofros.validation`, with `symofros.reference_models` beside it. In a checkout both are folders
beside `symofros`, called `validation` and `reference_models`; an editable installation knows both names. A process
loads them under one name, and gets the same modules under the other. A user's own `validation` is never taken for it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec, spec_from_loader
from pathlib import Path
from types import ModuleType

from symofros.errors import Problem, SymofrosError

_HARNESS = "validation"
_PACKAGE = Path(__file__).parent


def folder_of(package: str) -> Path:
    """Folder of `validation` or `reference_models`: within the package where a wheel installed it, or else beside it.

    Raises:
        SymofrosError: There is none.
    """
    for folder in (_PACKAGE / package, _PACKAGE.parent / package):
        if (folder / "__init__.py").is_file():
            return folder
    raise SymofrosError.of_extra(
        f"no package '{package}'",
        f"{_PACKAGE} is installed without it",
        "a wheel of symofros, and a checkout, has it",
        "validation",
    )


def package_name(package: str = _HARNESS) -> str:
    """The name of `validation` or `reference_models` in this process.

    Raises:
        SymofrosError: It is not there, or this process can't import it.
    """
    folder = folder_of(package)
    installed = f"symofros.{package}"
    for loaded in map(sys.modules.get, (installed, package)):
        if loaded is not None and _is_at(loaded.__file__, folder):
            return loaded.__name__
    if folder.parent == _PACKAGE:
        return installed
    # Searched by path: a package of the user's that is loaded under this name says nothing of the checkout.
    beside = PathFinder.find_spec(package)
    if beside is not None and _is_at(beside.origin, folder):
        return package
    mapped = find_spec(installed)
    if mapped is not None and _is_at(mapped.origin, folder):
        return installed
    raise SymofrosError(
        f"the package '{package}' of a checkout can't be imported",
        f"{folder} is not on the path of this process" if beside is None else f"{beside.origin} comes before it",
        f"a process finds it as '{package}' by its path, or as '{installed}' by an installation",
        f"pip install -e {folder.parent}",
    )


def harness_module(name: str) -> ModuleType:
    """A module of the harness, such as "ci.items"; this loads it, and whatever engines it needs."""
    return import_module(f"{package_name()}.{name}")


def command_line(arguments: Sequence[str]) -> list[str]:
    """The command of a process of its own that runs the harness's command line.

    Its interpreter finds this package and its harness first, wherever it is started: the folder of the call is not
    searched for modules (-P).
    """
    package = f"symofros.{_HARNESS}" if folder_of(_HARNESS).parent == _PACKAGE else _HARNESS
    start = f"import sys; sys.path.insert(0, {str(_PACKAGE.parent)!r}); from {package}.__main__ import app; "
    return [sys.executable, "-P", "-c", f"{start}app(prog_name='symofros validation')", *arguments]


def _is_at(file: str | None, folder: Path) -> bool:
    """Whether a module's file is the beginning of the package in a folder."""
    beginning = folder / "__init__.py"
    return file is not None and os.path.exists(file) and os.path.samefile(file, beginning)


def claim(name: str) -> None:
    """Called by `validation` and `reference_models` as they are loaded: their other name gets the same modules.

    Args:
        name: The `__name__` of the package that is loaded first.

    Raises:
        ImportError: It is loaded from elsewhere than it belongs to this package.
    """
    package = name.rpartition(".")[2]
    folder = folder_of(package)
    loaded = sys.modules.get(name)
    if loaded is not None and not _is_at(loaded.__file__, folder):
        found, rule = f"{name} is {loaded.__file__}", f"symofros is {_PACKAGE}, which belongs to {folder}"
        raise ImportError(str(Problem("two installations are mixed", found, rule, f"pip install -e {folder.parent}")))
    claimed = any(isinstance(finder, _OtherName) and finder.name == name for finder in sys.meta_path)
    if folder.parent != _PACKAGE and not claimed:  # A wheel has one name only, and `validation` is the user's.
        other = package if name != package else f"symofros.{package}"
        sys.meta_path.insert(0, _OtherName(other, name, folder))


class _OtherName(MetaPathFinder, Loader):
    """Finds the modules of a package under its other name: those that are loaded under the first.

    Args:
        other: The other name.
        name: The name under which the package is loaded.
        folder: Folder of the package; another that comes first on the path is not it.
    """

    def __init__(self, other: str, name: str, folder: Path) -> None:
        self.other, self.name, self.folder = other, name, folder

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Spec of a module under its other name."""
        return spec_from_loader(fullname, self) if self._is_ours(fullname) else None

    def _is_ours(self, fullname: str) -> bool:
        if fullname.startswith(f"{self.other}."):
            return self.name in sys.modules and sys.modules.get(self.other) is sys.modules[self.name]
        if fullname != self.other or "." in self.other:
            return fullname == self.other
        found = PathFinder.find_spec(fullname)
        return found is not None and _is_at(found.origin, self.folder)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """The module of the first name, which keeps its own specification."""
        module = import_module(self.name + spec.name.removeprefix(self.other))
        spec.loader_state = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing, as the module has been executed."""
        module.__spec__ = module.__spec__ and module.__spec__.loader_state
