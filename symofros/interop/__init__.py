"""Models in other frameworks: sf.interop.torch, jax, casadi, gymnasium; each needs the extra of its name."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

_MODULES = ("casadi", "gymnasium", "jax", "torch")


def __getattr__(name: str) -> ModuleType:
    """Import one of the modules at its first use: the frameworks are large, and may be missing."""
    if name not in _MODULES:
        raise AttributeError(f"module 'symofros.interop' has no attribute '{name}'; there are: {', '.join(_MODULES)}")
    return import_module(f"symofros.interop.{name}")


def __dir__() -> list[str]:
    """The modules."""
    return [*_MODULES]
