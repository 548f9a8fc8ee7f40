"""Cells of the matrix: engines, trees and functions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import EnginePlugin, Tree, Unsupported, vector
from validation.engines.truth import random_state
from validation.engines.verdicts import Cell, expected, judge

SEED = 20


def cells(plugin: EnginePlugin, tree: Tree, functions: Iterable[str] = ()) -> Iterator[Cell]:
    """All cells of one engine on one tree."""
    if plugin.gravity:
        tree = replace(tree, gravity=vector(np.array(plugin.gravity)))
    model = plugin.build(tree)
    chosen = list(functions) or list(FUNCTIONS) + [name for name in plugin.functions if name not in FUNCTIONS]
    for function in chosen:
        if function not in plugin.functions:
            yield Cell(plugin.name, tree.name, function, "not offered")
        elif isinstance(model, Unsupported):
            yield Cell(
                plugin.name, tree.name, function, "refuses" if model.offered else "not offered", words=model.reason
            )
        else:
            state = random_state(tree, model, SEED)
            answer = model.call(function, state)
            want = expected(function, tree, model, state, plugin.slacks.get(function, 0.0))
            yield judge(plugin.name, tree, function, answer, want)
