"""Truths of single features, against other ways to the same numbers, and answers that are wrong by one of them."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from scipy.integrate import quad_vec
from scipy.interpolate import BSpline, CubicHermiteSpline, CubicSpline, KroghInterpolator
from scipy.linalg import expm, solve_continuous_are, solve_discrete_are
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation, Slerp

from tests.late import needs_extra
from validation.engines.functions import FUNCTIONS, suiting
from validation.engines.interface import STEP, Array, Slot, State
from validation.engines.matrix import cells
from validation.engines.models.files import skel
from validation.engines.models.files.drake import files
from validation.engines.models.single import trees
from validation.engines.plugins import OWN
from validation.engines.plugins.features import DART, DRAKE
from validation.engines.proving.pieces import Layout
from validation.engines.tree import FEATURES
from validation.engines.truth.derived import TruthOf
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.features import drives, elements, parameters, systems
from validation.engines.truth.geometry import bodies, curves
from validation.engines.truth.geometry.poses import CENTRE
from validation.engines.verdicts import expected, judge

_TREE = trees()["trajectories"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE = random_state(_TREE, _LAYOUT, 7)
_R, _Q = (Rotation.from_quat(x, scalar_first=True) for x in (_STATE.q, _STATE.q2))


def _of(function: TruthOf, state: State = _STATE) -> Array:
    return np.asarray(digits(Truth(_TREE, _LAYOUT).value(function, Point.of(state))))


def _time() -> float:
    w = _STATE.v2[0]
    return float(1.5 + 1.25 * w / (1 + abs(w)))


def test_no_function_hides_another() -> None:
    tables = [rows for name, rows in vars(suiting).items() if name.isupper() and isinstance(rows, dict)]
    names = Counter(name for rows in tables for name in rows if rows is not FUNCTIONS)
    assert max(names.values()) == 1


def test_each_feature_has_a_tree_and_a_function() -> None:
    needed = {need for function in FUNCTIONS.values() for need in function.needs}
    assert set(FEATURES) <= needed & set(trees())
    assert set(DRAKE) | set(DART) == set(FEATURES)


@pytest.mark.parametrize("name", curves.CURVES)
def test_curves_are_those_of_scipy(name: str) -> None:
    x, breaks, t = np.array([_STATE.v, _STATE.a, _STATE.tau, _STATE.v2]), np.array(curves.BREAKS), _time()
    k = int(np.searchsorted(breaks, t)) - 1
    part = (t - breaks[k]) / (breaks[k + 1] - breaks[k])
    order, knots = curves.ORDER, np.array(curves.KNOTS)
    low, high = knots[order - 1], knots[-order]
    z = t / breaks[-1]
    want = {
        "held": lambda: x[k],
        "straight": lambda: x[k] + part * (x[k + 1] - x[k]),
        "lagrange": lambda: KroghInterpolator(breaks, x)(t),
        "hermite": lambda: CubicHermiteSpline(breaks, x, x[::-1])(t),
        "of_end_speeds": lambda: CubicSpline(breaks, x, bc_type=((1, x[3]), (1, x[0])))(t),
        "without_knots": lambda: CubicSpline(breaks, x, bc_type="not-a-knot")(t),
        "bernstein": lambda: sum(w * p for w, p in zip(_weights(z), x, strict=True)),
        "spline": lambda: BSpline(knots, x, order - 1)(low + (high - low) * z),
    }[name]()
    np.testing.assert_allclose(_of(curves.value(name)), want, rtol=1e-12, atol=1e-13)


def _weights(z: float) -> list[float]:
    return [(1 - z) ** 3, 3 * z * (1 - z) ** 2, 3 * z**2 * (1 - z), z**3]


def test_turns_between_are_those_of_scipy() -> None:
    breaks, t = list(curves.BREAKS[:3]), min(_time(), curves.BREAKS[2])
    way = Slerp(breaks, Rotation.concatenate([_R, _Q, _R * _Q]))
    np.testing.assert_allclose(_of(curves.orientation).reshape(3, 3), way(t).as_matrix(), atol=1e-13)
    step = 1e-6
    turned = (way(t + step) * way(t - step).inv()).as_rotvec() / (2 * step)
    np.testing.assert_allclose(_of(curves.turning), turned, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("name", systems.INTEGRATORS)
def test_steps_of_integrators_have_their_order(name: str) -> None:
    order = {"explicit_euler": 1, "radau1": 1, "runge_kutta2": 2, "runge_kutta5": 5}.get(name, 3)

    def f(x: Array) -> Array:
        return np.asarray(x / (1 + np.abs(x)))

    A = np.array([f(_STATE.v), f(_STATE.a), f(_STATE.v2)]) - 2 * np.eye(3)
    whole = expm(STEP * np.block([[A, f(_STATE.v)[:, None]], [np.zeros((1, 4))]]))
    exact = whole[:3, :3] @ _STATE.tau + whole[:3, 3]
    off = float(np.max(np.abs(_of(systems.stepped(name)) - exact)))
    assert 1e-3 * (STEP / 4) ** (order + 1) < off < (4 * STEP) ** (order + 1)


def test_regulators_are_those_of_scipy() -> None:
    x = np.abs(_STATE.v) + 0.5
    A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]])
    S = solve_continuous_are(A, B, np.diag(x[:2]), [[x[2]]])
    np.testing.assert_allclose(_of(systems.regulator), [*(B.T @ S / x[2]).flat, *S.flat], rtol=1e-10)
    S = solve_discrete_are(*(np.array([[y]]) for y in (*x, 1.0)))
    np.testing.assert_allclose(_of(systems.discrete_regulator)[1], S[0, 0], rtol=1e-10)


def test_a_hull_leaves_out_the_dent() -> None:
    corners = np.array(bodies.CORNERS) * (np.abs(_STATE.v) + 0.5)
    hull = ConvexHull(corners)
    assert set(hull.vertices) == {0, 1, 2, 3}
    whole, dented = _of(bodies.mesh(bodies.HULL)), _of(bodies.mesh(bodies.DENTED))
    assert whole[0] == pytest.approx(bodies.DENSITY * hull.volume, rel=1e-13)
    assert whole[0] > 1.2 * dented[0]
    # The dent takes away the tetrahedron of its corners.
    dent = np.linalg.det(corners[1:4] - corners[4]) / 6.0
    assert dented[0] == pytest.approx(whole[0] - bodies.DENSITY * abs(dent), rel=1e-13)


def test_moments_of_a_mesh_are_integrals() -> None:
    """Of the tetrahedron x/a + y/b + z/c < 1, layer by layer: triangles of the area a b (1 - z/c)^2 / 2."""
    a, b, c = np.abs(_STATE.v) + 0.5

    def layer(z: float) -> Array:
        s = 1.0 - z / c
        area = a * b * s**2 / 2.0
        of_unit = [1.0, a * s / 3.0, z, (b * s) ** 2 / 6.0 + z**2, a * b * s**2 / 12.0]
        return np.array([area * one for one in of_unit])

    mass, x, z, xx, xy = bodies.DENSITY * quad_vec(layer, 0.0, c)[0]
    found = _of(bodies.mesh(bodies.HULL))
    np.testing.assert_allclose(found[[0, 1, 3, 4, 7]], [mass, x / mass, z / mass, xx, -xy], rtol=1e-12)


def test_a_bushing_takes_energy_by_its_dampers_alone() -> None:
    """Without speeds its wrench is what it stores by a turn and a shift; the torque's power is that along the rates."""
    still = State(_STATE.q, 0 * _STATE.v, _STATE.a, _STATE.tau, 0 * _STATE.v2, _STATE.q2)
    wrench = _of(elements.bushing, still)
    angles = _R.as_euler("ZYX")[::-1]
    turned = Rotation.from_rotvec(_R.as_rotvec() / 2.0)
    place = _STATE.a + _R.apply(CENTRE)
    force = -turned.apply(np.array(elements.FORCES[0]) * turned.inv().apply(place))
    np.testing.assert_allclose(wrench[:3], force, rtol=1e-12)
    moment = wrench[3:] - np.cross(place / 2.0 - _STATE.a, force)
    small = Rotation.from_rotvec(1e-6 * np.array([0.3, -0.4, 0.5]))
    ahead = (small * _R).as_euler("ZYX")[::-1]
    work = -np.array(elements.TORQUES[0]) * angles @ (ahead - angles)
    assert 1e-6 * moment @ [0.3, -0.4, 0.5] == pytest.approx(work, rel=1e-5)


def test_locked_bodies_move_with_their_carrier() -> None:
    after = _of(parameters.locked)
    x, y, _ = parameters.MASSES
    assert after[3] == pytest.approx(_STATE.a[0] + STEP * _STATE.tau[0] / (x + y), rel=1e-14)
    assert after[1] == _STATE.v[1] and after[4] == 0.0


@pytest.mark.parametrize(
    ("name", "answer"),
    [
        ("slide_servo_from_limit", [drives.LIMIT, 0.0]),
        ("mass_with_rotor", [1.0]),
        ("convex_hull_of_mesh", _of(bodies.mesh(bodies.DENTED)).tolist()),
    ],
)
def test_faults_of_past_releases_are_red(name: str, answer: list[float]) -> None:
    """A servo that stays where it is, a rotor that is left out, the mesh in place of its hull."""
    want = expected(name, _TREE, _LAYOUT, _STATE)
    assert judge("planted", _TREE, name, np.array(answer), want).verdict == "wrong"
    assert judge("planted", _TREE, name, want.value, want).verdict == "right"


def test_files_of_drake_state_rotors_behind_gears() -> None:
    reading = files()["urdf of drake: rotor and gear"]
    assert reading.tree.links[0].joints[0].armature == (0.25 * 3.0**2,)


def test_a_joint_of_skel_is_placed_in_its_child() -> None:
    """The child's origin, at zero, is where its body stands: (0, 0, 0.5) of the body before, not turned."""
    tree = skel.files()["skel: joint placed in its child"].tree
    joint, back = tree.links[1].joints
    np.testing.assert_allclose(np.array(joint.p) + np.array(joint.R) @ back.p, [0.0, 0.0, 0.5], atol=1e-15)
    np.testing.assert_allclose(np.array(joint.R) @ back.R, np.eye(3), atol=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["drake", "dart"])
def test_engines_are_right_but_for_what_is_stated(name: str) -> None:
    if not OWN[name].version():
        pytest.skip(needs_extra(f"engine-{name}", OWN[name].package))
    known = {
        "drake": {"coordinates_set:Clone", "power_of_damping", "wing_force"},
        "dart": {"slide_servo_from_limit"},
    }[name]
    asked = trees()
    red = {
        cell.function
        for feature in FEATURES
        for cell in cells(OWN[name], asked[feature])
        if cell.verdict not in ("right", "not offered")
    }
    assert red == known
