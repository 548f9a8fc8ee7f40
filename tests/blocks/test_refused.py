"""What is stated wrongly of a block is refused: the rows of refused.yaml."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from symofros.blocks import Formula, JointPD, PythonBlock, Saturation, StateSpace
from symofros.diagrams.files.registry import kinds
from tests.blocks.support import refused, run

STATES = ("q_desired", "v_desired", "q", "v")
ROWS = YAML(typ="safe").load(Path(__file__).with_name("refused.yaml"))


@pytest.mark.parametrize("kind", ROWS)
def test_invalid_fields_of_every_block_are_refused(kind: str) -> None:
    for fields, *says in ROWS[kind]:
        refused(lambda fields=fields: kinds()[kind](name="b", **fields), *says)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: run(JointPD(name="c", kp=[1, 2, 3], kd=1), dict.fromkeys(STATES, np.zeros((8, 2)))), ("(3,)",)),
        (lambda: run(Saturation(name="b", low=[0, 0]), {"u": np.zeros((2, 3))}), ("(2,)", "one an entry")),
        (lambda: run(Formula(name="f", formulas="u[3]"), {"u": np.zeros((2, 3))}), ("(3,)",)),
        (lambda: run(Formula(name="f", formulas="sqrt(0 - 1)"), t_end=0.1), ("not a number",)),
        (lambda: StateSpace(name="s", A=np.eye(201), B=np.ones((201, 1)), C=np.ones((1, 201))), ("201", "reduce")),
        (lambda: PythonBlock(name="p", function=print, period=1.0), ("none",)),
        (lambda: PythonBlock(name="p", function=print, outputs={"y": ()}), ("period None",)),
    ],
)
def test_fields_that_contradict_inputs_or_files_are_refused(make: Callable[[], object], says: tuple[str, ...]) -> None:
    refused(make, *says)
