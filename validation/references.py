"""The reference models: the package beside the harness, under whatever name both are installed."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from symofros.harness import package_name

_PACKAGE = package_name("reference_models")


def reference_module(name: str) -> Any:
    """A module of the reference models, such as "closed.two_arms"; what it has is declared where it is used."""
    return import_module(f"{_PACKAGE}.{name}")


if TYPE_CHECKING:
    from reference_models import MODELS as MODELS
else:
    MODELS = import_module(_PACKAGE).MODELS
# Folder of their files.
FOLDER = Path(str(import_module(_PACKAGE).__file__)).parent
