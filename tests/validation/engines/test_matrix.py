"""Engines against the truth, on small trees."""

from __future__ import annotations

import pytest

from validation.engines.kinds import tree_of
from validation.engines.matrix import cells
from validation.engines.plugins import OWN


@pytest.mark.parametrize("engine", ["pinocchio", "mujoco"])
def test_an_engine_is_right_about_a_ball_joint_between_oblique_links(engine: str) -> None:
    verdicts = {cell.function: cell.verdict for cell in cells(OWN[engine], tree_of("ball"), ("mass_matrix", "bias"))}
    assert verdicts == {"mass_matrix": "right", "bias": "right"}
