"""Laws of friction and steps where their parts meet; connectors and loads are asked of Exudyn in `test_asked.py`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from validation.engines.functions import FUNCTIONS
from validation.engines.interface import Slot, State
from validation.engines.matrix import cells
from validation.engines.models.kinds import tree_of
from validation.engines.models.single import trees
from validation.engines.plugins import OWN
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.features import connectors

_TREE = trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE = random_state(_TREE, _LAYOUT, 3)


def _of(name: str, state: State = _STATE) -> NDArray[np.float64]:
    return digits(Truth(_TREE, _LAYOUT).value(FUNCTIONS[name].truth, Point.of(state)))


def test_laws_go_on_where_their_parts_meet() -> None:
    least, more, _, _, regular = connectors.FRICTION
    at = replace(_STATE, v=np.array([regular, np.nextafter(regular, 1.0), 2 * regular]))
    np.testing.assert_allclose(_of("friction_stribeck", at)[:2], least + more, atol=1e-14)
    np.testing.assert_allclose(_of("friction_regularized", at), [least + more, least + more, least], atol=1e-14)
    at = replace(_STATE, v=np.array([-0.25, 0.125, 0.5]))
    np.testing.assert_allclose(_of("smooth_step", at), [-0.5, 0.5, 1.5, 0.0, np.pi / 0.75, 0.0], atol=1e-14)
    np.testing.assert_allclose(_of("stress_von_mises", replace(_STATE, v=np.array([2.0, 0.0, 0.0]), a=0 * at.a)), [2.0])


def test_trees_of_python_are_right_but_for_slides() -> None:
    names = tuple(name for name in OWN["exudyn"].functions if ":KinematicTree" in name or ":Robot" in name)
    verdicts = {
        kind: {cell.function for cell in cells(OWN["exudyn"], tree_of(kind), names) if cell.verdict == "wrong"}
        for kind in ("revolute oblique", "prismatic")
    }
    forces = {f"{name}:KinematicTree66" for name in ("mass_matrix", "bias", "forward_dynamics")}
    assert verdicts["revolute oblique"] == set()
    assert verdicts["prismatic"] == forces | {"mass_matrix:KinematicTree33", "forward_dynamics:KinematicTree33"}
