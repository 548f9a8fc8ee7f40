"""Packages that take a second to import: every worker collects all files, and few run the tests that need them."""

from __future__ import annotations

import os
import shutil
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import pytest


class LateModule:
    """A module that is imported when an attribute of it is first asked for.

    Unlike a module of `importlib.util.LazyLoader`, it is not in `sys.modules` before: SciPy looks there for packages of
    arrays.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        if attribute.startswith("__") or attribute == "_mock_name":  # Pytest asks for these of every name in a file.
            raise AttributeError(attribute)
        return getattr(import_module(self._name), attribute)


def late(name: str, extra: str = "") -> Any:
    """A module for the tests of a file; they are skipped where it is of an extra that is not installed."""
    if extra and find_spec(name) is None:
        pytest.skip(needs_extra(extra, name), allow_module_level=True)
    return LateModule(name)


def needs_extra(extra: str, package: str) -> str:
    """The reason to skip what a package of an extra is missing for; the summary of a run counts these by extra."""
    return f"needs the extra '{extra}': the package {package} is not installed"


def require(package: str, extra: str) -> Any:
    """A package; the test, or the file, that asks for it is skipped where its extra is not installed."""
    return pytest.importorskip(package, reason=needs_extra(extra, package))


# Beginning of scripts that stand for other programs, and use the system's utilities.
SHELL = "#!/bin/sh\nPATH=$PATH:/bin:/usr/bin\n"


def with_utilities() -> dict[str, str]:
    """The environment of a process in which a test itself uses the system's utilities: they are where it has them.

    The path of a run may have no more on it than what SYMOFROS needs.
    """
    return os.environ | {"PATH": os.pathsep.join((os.environ["PATH"], os.defpath))}


def needs_program(name: str) -> None:
    """Skip a test that uses a program which the system lacks."""
    if shutil.which(name, path=with_utilities()["PATH"]) is None:
        pytest.skip(f"needs a program called {name}")
