"""iDynTree: floating-base dynamics from URDF, its algorithms, sensors, models that are made of others."""

from __future__ import annotations

from .plugin import PLUGIN as PLUGIN
