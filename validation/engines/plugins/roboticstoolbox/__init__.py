"""Robotics Toolbox for Python: robots of elementary transforms, of Denavit and Hartenberg's parameters, of twists."""

from __future__ import annotations

from .plugin import PLUGIN as PLUGIN
