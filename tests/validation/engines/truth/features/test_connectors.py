"""Connectors, loads and laws of friction, by powers, by energies and by what textbooks have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

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


def _rotation(q: NDArray[np.float64]) -> Rotation:
    return Rotation.from_quat([*q[1:], q[0]])


def _points(state: State) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    first = state.a + _rotation(state.q).apply(connectors.FIRST)
    return first, state.tau + connectors.BEYOND + _rotation(state.q2).apply(connectors.SECOND)


def _energy(name: str, state: State) -> float:
    first, second = _points(state)
    apart = second - first
    length = np.linalg.norm(apart)
    if name == "connector_spring":
        rest = connectors.REST - connectors.FORCE / connectors.STIFFNESS
        return float(connectors.STIFFNESS / 2 * (length - rest) ** 2)
    if name == "connector_gravity":
        return float(-connectors.PULL * np.prod(connectors.MASSES) / length)
    return float(np.array(connectors.ALONG) @ (apart - connectors.OFFSET) ** 2 / 2)


@pytest.mark.parametrize("name", ["connector_spring", "connector_along_axes", "connector_gravity"])
def test_forces_at_rest_are_slopes_of_an_energy(name: str) -> None:
    still = replace(_STATE, v=0 * _STATE.v, v2=0 * _STATE.v2)
    step, found = 1e-6, _of(name, replace(still, tau=0 * still.tau))

    def moved(k: int, by: float) -> State:
        unit = by * np.eye(3)[k % 3]
        turned = Rotation.from_rotvec(unit)
        q, q2 = (np.roll((_rotation(one) * turned).as_quat(), 1) for one in (still.q, still.q2))
        place = replace(still, tau=0 * still.tau)
        parts = ({"a": still.a + unit}, {"q": q}, {"tau": unit}, {"q2": q2})
        return replace(place, **parts[k // 3])  # type: ignore[arg-type]

    slopes = [(_energy(name, moved(k, step)) - _energy(name, moved(k, -step))) / (2 * step) for k in range(12)]
    np.testing.assert_allclose(found, np.negative(slopes), atol=1e-7)


@pytest.mark.parametrize("name", ["connector_spring", "connector_along_axes"])
def test_dampers_take_power(name: str) -> None:
    speeds = np.concatenate([_STATE.v, _STATE.tau, _STATE.v2, _STATE.v])
    still = replace(_STATE, v=0 * _STATE.v, v2=0 * _STATE.v2)
    # tau places the second body, too: the first turns at it in both states.
    elastic = _of(name, still)
    first = np.concatenate([_STATE.v * 0, _STATE.tau, _STATE.v2 * 0, _STATE.v * 0])
    assert (_of(name) - elastic) @ (speeds - first) < 0


@pytest.mark.parametrize(("name", "follows"), [("load_before", False), ("load_following", True)])
def test_a_load_is_at_its_point(name: str, follows: bool) -> None:
    R = _rotation(_STATE.q)
    force, moment = (R.apply(x) if follows else np.array(x) for x in (connectors.PUSHED, connectors.TWISTED))
    moment = R.inv().apply(moment + np.cross(R.apply(connectors.FIRST), force))
    np.testing.assert_allclose(_of(name), [*force, *moment], atol=1e-14)


def test_angles_and_velocities_of_a_body() -> None:
    displaced, sensed, R = _of("body_displaced"), _of("body_sensed"), _rotation(_STATE.q)
    np.testing.assert_allclose(Rotation.from_euler("XYZ", displaced[3:]).as_matrix(), R.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(sensed[3:6], _STATE.v + R.apply(np.cross(_STATE.tau, connectors.FIRST)), atol=1e-14)
    np.testing.assert_allclose(sensed[:6], _of("point_sensed"), atol=0)


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
