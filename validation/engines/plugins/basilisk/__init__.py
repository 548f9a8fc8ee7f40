"""Basilisk, as its plug-in."""

from __future__ import annotations

from .plugin import PLUGIN as PLUGIN
