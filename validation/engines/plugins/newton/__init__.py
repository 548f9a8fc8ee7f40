"""Newton: articulations of Warp on the CPU, by its API and its readers."""

from __future__ import annotations

from .model import quaternion as quaternion
from .plugin import PLUGIN as PLUGIN
from .ways import QUIET as QUIET
