"""Plug-ins of the matrix without an adapter of their own, those of other packages among them, as judges of a check."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..contract.interface import Subject, Unsupported
from ..contract.quantities import FRAME_QUANTITIES
from ..engines.workers import registry
from .charted import ChartedEngine
from .charted import build as build_charted
from .compiled import NAME as OURS
from .stated import KINDS

# States in one call: each is a call of Python at least.
MOST_STATES = 100


def found() -> tuple[list[str], dict[str, str]]:
    """Names of the plug-ins that can be asked, and why others did not load, by name."""
    return [name for name in registry().plugins if name != OURS], registry().failures


def build(name: str, subject: Subject) -> ChartedEngine | Unsupported:
    """A plug-in's model of a rigid description.

    Each joint is stated whole, and all that is fixed to a link is one mass with it. Where the engine refuses links
    without mass for the subject's frames, it is asked without them.
    """
    plugin = registry().plugins.get(name)
    if plugin is None:
        return Unsupported(f"no package here offers a plug-in '{name}'")
    if not plugin.version():
        return Unsupported(f"not installed: pip install '{plugin.extra}'")
    if plugin.gravity and not np.array_equal(plugin.gravity, subject.assembly.gravity):
        return Unsupported(f"its gravity is {tuple(plugin.gravity)} m/s^2, not the description's")
    own = {kind.partition(" ")[0] for kind in plugin.kinds}
    joints = frozenset(part for part, kind in KINDS.items() if kind in own)
    splits = "free between links" not in plugin.kinds
    engine = build_charted(plugin, subject, joints, whole=True, merged=True, splits_free=splits)
    silent = frozenset[str]()
    if isinstance(engine, Unsupported) and subject.frames:
        bare = build_charted(plugin, replace(subject, frames=()), joints, whole=True, merged=True, splits_free=splits)
        engine, silent = (engine if isinstance(bare, Unsupported) else bare), FRAME_QUANTITIES
    if isinstance(engine, Unsupported):
        return engine
    offered = engine.capabilities - silent
    return replace(engine, capabilities=offered, most_states=MOST_STATES)
