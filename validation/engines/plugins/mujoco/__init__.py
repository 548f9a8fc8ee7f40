"""MuJoCo: models by its XML, their functions, constraints, forces and flexible bodies."""

from __future__ import annotations

from .document import document as document
from .functions import WAYS as WAYS
from .plugin import CHANGED as CHANGED
from .plugin import PLUGIN as PLUGIN
from .plugin import write as write
