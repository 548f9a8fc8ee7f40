"""What is asked beside mechanisms, by name: rotations, solids, flexible bodies; and lines around surfaces."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.late import needs_extra
from validation.engines.causes.cause import stated
from validation.engines.interface import Slot, Tree
from validation.engines.matrix import SEED, Truths, asked, cells, judged
from validation.engines.models import flexible, single
from validation.engines.models.files import mjcf_geoms
from validation.engines.plugins import OWN
from validation.engines.proving.pieces import Layout
from validation.engines.truth import derived
from validation.engines.truth.arithmetic import Exact, arc, cos_sin, exact, many_digits
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry import turns
from validation.engines.truth.kinematics import around
from validation.engines.verdicts import expected, judge
from validation.engines.workers import Job, answered

TURNS = single.trees()["rotations"]


def _truth() -> tuple[Truth, Point]:
    layout = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
    return Truth(TURNS, layout), Point.of(random_state(TURNS, layout, 1))


def test_an_angle_comes_back_in_many_digits() -> None:
    with many_digits():
        for angle in exact([0.3, 2.5, -1.25, 3.125]):
            assert abs(arc(*(5 * part for part in cos_sin(angle))) - angle) < exact(1e-100)[()]


@pytest.mark.parametrize(
    ("name", "angle", "apart", "is_opposite"),
    [
        ("rotations, 2^-27 from half turns", math.pi, None, None),
        ("rotations, 2^-12 from half turns about an axis", math.pi, None, None),
        ("rotations, 2^-12 from each other", None, 0.0, False),
        ("rotations, 2^-27 from each other's opposite", None, 0.0, True),
        ("rotations, each other's opposite", None, 0.0, True),
        ("rotations, one axis", None, None, None),
    ],
)
@pytest.mark.parametrize("last", [False, True])
def test_rotations_are_as_special_as_their_tree_says(
    name: str, angle: float | None, apart: float | None, is_opposite: bool | None, last: bool
) -> None:
    tree = single.trees()[name]
    chart = "quaternion xyzw, body speeds" if last else "quaternion wxyz, body speeds"
    layout = Layout(4, 3, ((Slot(chart, (0, 1, 2, 3), (0, 1, 2)),),))
    near = 4.0 * 2.0**-tree.near if tree.near else 1e-15
    for seed in range(8):
        state, truth = random_state(tree, layout, seed), Truth(tree, layout)
        with many_digits():
            R, Q = (turns.turn(truth, exact(x)) for x in (state.q, state.q2))
            vector, between = digits(turns.rotation_vector(R)), digits(turns.rotation_vector(R.T @ Q))
        assert angle is None or 0.0 < angle - np.linalg.norm(vector) < near
        assert apart is None or np.linalg.norm(between) < near
        assert is_opposite is None or (state.q @ state.q2 < 0.0) == is_opposite
        if name.endswith("axis"):
            assert np.sum(np.abs(vector) > near) == 1


def _points(*values: tuple[float, float, float]) -> list[Exact]:
    return [exact(value) for value in values]


@pytest.mark.parametrize("is_sphere", [True, False])
def test_a_line_around_half_a_circle(is_sphere: bool) -> None:
    with many_digits():
        a, b = _points((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
        length = around(a, b, exact(0.5)[()], is_sphere)
    # Two tangents and the arc between them: pi less twice the angle whose cosine is a half.
    assert float(length) == pytest.approx(2 * math.sqrt(0.75) + 0.5 * (math.pi - 2 * math.acos(0.5)), rel=1e-15)


def test_a_line_rises_around_a_cylinder_and_not_around_a_sphere() -> None:
    with many_digits():
        a, b = _points((-1.0, 0.0, 0.0), (1.0, 0.0, 1.0))
        flat = around(a, exact((1.0, 0.0, 0.0)), exact(0.5)[()], False)
        risen = around(a, b, exact(0.5)[()], False)
    assert float(risen) == pytest.approx(math.hypot(float(flat), 1.0), rel=1e-15)


@pytest.mark.parametrize("is_sphere", [True, False])
def test_a_line_passes_a_surface_on_the_side_of_a_point(is_sphere: bool) -> None:
    radius, tangent = 0.5, math.sqrt(1.0625 - 0.25)
    # Both ends are 0.25 above the centre: the arc over it is shorter than that beneath by four times their elevation.
    over = math.pi - 2 * math.atan(0.25) - 2 * math.acos(radius / math.sqrt(1.0625))
    under = over + 4 * math.atan(0.25)
    with many_digits():
        a, b = _points((-1.0, 0.25, 0.0), (1.0, 0.25, 0.0))
        # The last stands near the normal of the plane of the ends and the centre: its part in that plane counts.
        for side, way in (((0.0, 1.0, 0.0), over), ((0.3, -1.0, 0.5), under), ((0.0, 0.125, 3.0), over)):
            length = around(a, b, exact(radius)[()], is_sphere, exact(side))
            assert float(length) == pytest.approx(2 * tangent + radius * way, rel=1e-15)
        # Above the surface the line is straight on the side above only.
        a, b = _points((-1.0, 0.75, 0.0), (1.0, 0.75, 0.0))
        assert float(around(a, b, exact(radius)[()], is_sphere, exact((0.0, 1.0, 0.0)))) == 2.0
        assert float(around(a, b, exact(radius)[()], is_sphere, exact((0.0, -1.0, 0.0)))) > 2.5


def test_a_line_that_passes_a_surface_or_begins_in_it_is_straight() -> None:
    with many_digits():
        a, b, inside = _points((-1.0, 2.0, 0.0), (1.0, 2.0, 0.0), (0.25, 0.0, 0.0))
        assert float(around(a, b, exact(0.5)[()], True)) == 2.0
        assert float(around(inside, b, exact(0.5)[()], True)) == pytest.approx(math.hypot(0.75, 2.0), rel=1e-15)


def test_a_mesh_has_the_inertia_of_the_box_that_it_is() -> None:
    """Full: m (y^2 + z^2) / 12. A shell: its walls, each a plate, about the middle of the box."""
    files = mjcf_geoms.files()
    x, y, z = 0.5, 0.25, 0.75
    for scale, name in (((1.0, 1.0, 1.0), "of a mass"), ((2.0, 1.0, 0.5), "that is scaled")):
        size = np.multiply((x, y, z), scale)
        link = files[f"mjcf: mesh {name}"].tree.links[1]
        np.testing.assert_allclose(link.com, size / 2.0, rtol=1e-14)
        np.testing.assert_allclose(link.inertia, np.diag(size @ size - size**2) / 4.0, rtol=1e-13, atol=1e-15)
    shell = files["mjcf: mesh that is a shell, of a density"].tree.links[1]
    walls = 12.0 * np.array([y * z, x * z, x * y])
    assert shell.mass == pytest.approx(walls.sum(), rel=1e-14)
    square = np.array([x, y, z]) ** 2
    second = [sum(walls[i] * square[k] / (4.0 if i == k else 12.0) for i in range(3)) for k in range(3)]
    np.testing.assert_allclose(shell.inertia, np.diag(sum(second) - np.array(second)), rtol=1e-13, atol=1e-15)


def test_a_solid_stands_where_its_joint_puts_it() -> None:
    tree = single.trees()["primitive cylinder of a density"]
    (body,) = tree.links
    layout = Layout(0, 0, ((),))
    mass, *rest = digits(Truth(tree, layout).value(derived.solid_inertia, Point.of(random_state(tree, layout, 1))))
    assert mass == pytest.approx(2.0 * math.pi * 0.25 * 2.0, rel=1e-15)
    np.testing.assert_array_equal(rest[:3], body.joints[0].p)
    xx, yy, zz, xy, xz, yz = rest[3:]
    moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    across = mass * (0.25 / 4.0 + 4.0 / 12.0)
    np.testing.assert_allclose(moments, [mass * 0.125, across, across], rtol=1e-14)
    assert abs(xy) > 0.05


def test_a_capsule_is_a_solid_of_revolution() -> None:
    """Discs of the radius that each height has, summed by Gauss's rule on each piece, where they are polynomials."""
    (body,) = single.trees()["primitive capsule of a density"].links
    nodes, weights = np.polynomial.legendre.leggauss(4)
    mass = along = across = 0.0
    for low, high, middle, curved in ((-1.0, 1.0, 0.0, 0.0), (1.0, 2.0, 1.0, 1.0), (-2.0, -1.0, -1.0, 1.0)):
        z, disc = (high - low) / 2.0 * nodes + (high + low) / 2.0, 2.0 * math.pi * (high - low) / 2.0 * weights
        r = 1.0 - curved * (z - middle) ** 2
        mass, along = mass + float(disc @ r), along + float(disc @ r**2) / 2.0
        across += float(disc @ (r**2 / 4.0 + r * z**2))
    assert body.mass == pytest.approx(mass, rel=1e-14)
    np.testing.assert_allclose(np.diag(body.inertia), [across, across, along], rtol=1e-14)


def _verdicts(engine: str, tree: Tree) -> dict[str, str]:
    return {cell.function: cell.verdict for cell in cells(OWN[engine], tree)}


def test_a_series_that_ends_early_and_a_half_turn_of_another_sign_are_red_cells() -> None:
    """The first is right where its angle is large enough for another formula, and so is the second for most axes."""
    tree = single.trees()["rotations, 2^-8 from none"]
    (answer,) = answered(Job("pinocchio", tree, ("rotation_exponential",), SEED))
    assert answer.layout is not None and answer.state is not None
    x, y, z = answer.state.v
    S = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    want = expected("rotation_exponential", tree, answer.layout, answer.state)
    given = (np.eye(3) + S + S @ S / 2.0).ravel()
    assert judge("planted", tree, "rotation_exponential", np.asarray(answer.value), want).verdict == "right"
    assert judge("planted", tree, "rotation_exponential", given, want).verdict == "imprecise"
    half = expected("rotation_half_turns", tree, answer.layout, answer.state)
    flipped = half.value.copy()
    flipped[turns.AXES.index((1, 0, 2)), [2, 6]] *= -1.0
    assert judge("planted", tree, "rotation_half_turns", flipped, half).verdict == "wrong"


def _others(engine: str, name: str) -> set[str]:
    """What an engine has otherwise at one state, but for what has its causes stated."""
    plugin, tree = OWN[engine], single.trees()[name]
    found = [one.cell for one in judged(plugin, Job(engine, tree, asked(plugin, tree), SEED), Truths())]
    assert len(found) > 60
    return {x.function for x in found if x.verdict != "right" and not any(cause.explains(x) for cause in stated())}


# Each by itself, so that each is drawn about every other day.
def test_pinocchio_is_right_about_rotations() -> None:
    assert not _others("pinocchio", "rotations")


def test_mujoco_is_right_about_rotations_and_solids() -> None:
    assert not _others("mujoco", "rotations")


def test_mujoco_is_right_about_vectors() -> None:
    assert not _others("mujoco", "vectors")


def test_exudyn_is_right_about_rotations_and_connectors() -> None:
    assert not _others("exudyn-joints", "rotations")


def test_points_of_another_place_and_no_weight_don_t_move_an_alignment() -> None:
    """With their weight they do."""
    plugin = OWN["trimesh"]
    if not plugin.version():
        pytest.skip(needs_extra("trimesh", "trimesh"))
    names = ("pose_aligned:weights of none", "pose_aligned:weights", "pose_aligned")
    none, *others = answered(Job("trimesh", TURNS, names, SEED))
    assert none.layout is not None and none.state is not None
    want = expected("pose_aligned", TURNS, none.layout, none.state)
    for one in (none, *others):
        assert judge("trimesh", TURNS, one.function, np.asarray(one.value), want).verdict == "right"
    way = plugin.ways[names[0]]  # type: ignore[attr-defined]
    planted = replace(plugin, ways={names[0]: way._replace(code=way.code.replace("np.sign", "np.exp"))})  # type: ignore[type-var]
    given = planted.build(TURNS).call(names[0], none.state)  # type: ignore[union-attr]
    assert judge("planted", TURNS, names[0], np.asarray(given), want).verdict == "wrong"


@pytest.mark.parametrize("name", [name for name in flexible.trees() if "implicit" not in name])
def test_flexible_bodies_don_t_feel_their_frames(name: str) -> None:
    assert _verdicts("mujoco", flexible.trees()[name]) == {"flexible_relation": "right"}


def test_who_does_not_know_what_is_asked_is_not_asked() -> None:
    assert _verdicts("exudyn", TURNS) == {}
    assert _verdicts("pinocchio", flexible.trees()["flexible cable: sum of forces"]) == {}
