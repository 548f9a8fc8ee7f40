"""Bodies alone on a joint, distances that are held, what files state of lines: the truth, MuJoCo, Newton by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.late import needs_extra, require
from validation.engines.causes.cause import stated
from validation.engines.interface import STEP, Slot, Tree
from validation.engines.matrix import SEED, Truths, cells, judged
from validation.engines.models import single
from validation.engines.models.files import mjcf_lines, urdf, usd
from validation.engines.plugins import OWN
from validation.engines.proving.pieces import Layout
from validation.engines.truth import derived, steps
from validation.engines.truth.arithmetic import many_digits
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.verdicts import judge
from validation.engines.workers import Job

SINGLE = single.trees()
LINES = mjcf_lines.files()
HINGE = Layout(1, 1, ((Slot("angle", (0,), (0,)),),))
LENGTH = Layout(1, 1, ((Slot("length", (0,), (0,)),),))
# What XPBD has wrong (`causes/stated/newton.yaml`).
WRONG = {"wheel on a hinge", "wheel on a damped hinge", "wheel on a ball", "wheel on a ball with dampers"}


def _at(tree: Tree, layout: Layout) -> tuple[Truth, Point]:
    return Truth(tree, layout), Point.of(random_state(tree, layout, SEED))


def test_the_holding_torque_of_a_wheel_is_its_torque_along_the_axis() -> None:
    tree = SINGLE["wheel on a hinge"]
    truth, point = _at(tree, HINGE)
    with many_digits():
        held, ((R, _),) = digits(derived.held_at_rest(truth, point)), truth.kinematics.poses(point.q)
    joint = tree.links[0].joints[0]
    assert np.allclose(held[:3], 0.0, atol=1e-15)
    assert np.allclose(held[3:], float(point.tau[0]) * digits(R) @ joint.axis, atol=1e-15)


def test_a_damper_slows_a_wheel() -> None:
    for name, damping in (("wheel on a hinge", 0.0), ("wheel on a damped hinge", 0.5)):
        truth, point = _at(SINGLE[name], HINGE)
        end = digits(truth.value(steps.single("nothing", steps.normalized), point))
        v, tau = float(point.v[0]), float(point.tau[0])
        assert np.isclose(end[1], v + STEP * (tau - damping * v) / 0.25, atol=1e-15)


def test_dampers_of_a_ball_are_stated_along_each_axis() -> None:
    assert OWN["newton"].building(SINGLE["wheel on a ball with dampers"]).count("damping=4.0") == 3
    assert "damping" not in OWN["newton"].building(SINGLE["wheel on a ball"])


@pytest.mark.parametrize(
    ("name", "want"),
    [("distance below its bounds", 2.0), ("distance beyond its bounds", 0.25), ("distance within its bounds", None)],
)
def test_a_distance_is_brought_within_its_bounds(name: str, want: float | None) -> None:
    truth, point = _at(SINGLE[name], LENGTH)
    (distance,) = digits(derived.held_distance(truth, point))
    assert distance == (want or abs(float(point.q[0])) + 0.5)


@pytest.mark.parametrize("name", LINES)
def test_mujoco_reads_lines_as_it_documents(name: str) -> None:
    one = LINES[name]
    asked = one.functions(OWN["mujoco"].functions)
    job = Job("mujoco", one.tree, asked, SEED, form=one.form, text=one.text)
    assert asked
    found = [one.cell for one in judged(OWN["mujoco"], job, Truths())]
    assert {cell.verdict for cell in found if not any(one.explains(cell) for one in stated())} == {"right"}


@pytest.mark.parametrize("function", ["tendon_rests", "tendon_armatures", "tendon_dampings", "tendon_arms"])
def test_a_default_that_is_forgotten_is_a_red_cell(function: str) -> None:
    """The file states all by default: without the class nothing is left of it."""
    one = LINES["mjcf: tendon of a sum by default"]
    text = one.text.replace('springlength="0.25" ', "").replace('armature="0.125"', "").replace('damping="0.5"', "")
    jobs = (
        Job("mujoco", one.tree, (function,), SEED, form="mjcf", text=each)
        for each in (one.text, text.replace('coef="-0.5"', 'coef="0.5"'))
    )
    (want,), (given,) = (list(judged(OWN["mujoco"], job, Truths())) for job in jobs)
    assert want.want is not None and want.cell.verdict == "right"
    assert judge("planted", one.tree, function, np.asarray(given.answer.value), want.want).verdict == "wrong"


def test_a_locked_joint_that_a_goal_moves_is_a_red_cell() -> None:
    require("pydrake", "engine-drake")
    tree = SINGLE["joints that are locked, held and coupled in a step"]
    (one,) = judged(OWN["drake"], Job("drake", tree, ("goal_of_locked",), SEED), Truths())
    assert one.cell.verdict == "right" and one.want is not None
    moved = np.asarray(one.answer.value) * [1.0, 0.0]
    assert judge("planted", tree, "goal_of_locked", moved, one.want).verdict == "wrong"


def test_builders_of_newton_make_what_is_stated() -> None:
    require("newton", "engine-newton")
    asked = ("coordinates_of_anchored", "velocity_of_turned_copy", "areas_of_triangles")
    tree = SINGLE["defaults and parameters: gears, rotors, dampers, model instances"]
    found = list(judged(OWN["newton"], Job("newton", tree, asked, SEED), Truths()))
    assert [one.cell.verdict for one in found] == ["right"] * 3
    for one in found:  # As it was kept: where the body stands, along the old axes, the area of the one before.
        assert one.want is not None
        old = np.roll(np.asarray(one.answer.value), 1)
        assert judge("planted", tree, one.cell.function, old, one.want).verdict == "wrong"


def test_depths_of_solids_and_meshes_that_are_mirrored_are_asked_of_mujoco() -> None:
    """Half a depth, that of a ball on the surface, a normal scaled as its vertex, a face from inside are red."""
    require("mujoco", "validation")
    planted = {
        "distance_box_in_box:contact": lambda x: x / 2.0,
        "distance_ball_in_box:contact": lambda x: x + 0.125,
        "distance_capsule_to_floor": lambda x: x + 0.125,
        "normal_of_mesh_scaled": lambda x: x * np.array([2.0, 0.5, 4.0]) ** 2,
        "face_of_tetrahedron_mirrored:file": lambda x: -x,
        "volume_of_tetrahedron_mirrored": lambda x: -x,
    }
    tree = SINGLE["rotations"]
    found = list(judged(OWN["mujoco"], Job("mujoco", tree, tuple(planted), SEED), Truths()))
    assert [one.cell.verdict for one in found] == ["right"] * len(planted)
    for one, fault in zip(found, planted.values(), strict=True):
        assert one.want is not None
        value = fault(np.asarray(one.answer.value))
        assert judge("planted", tree, one.cell.function, value, one.want).verdict == "wrong"


def test_a_mass_that_is_read_where_none_is_stated_is_a_red_cell() -> None:
    pytest.importorskip("yourdfpy")
    one = urdf.files()["urdf: mass without value"]
    for text, verdict in ((one.text, "right"), (one.text.replace("<mass/>", '<mass value="1"/>'), "wrong")):
        job = Job("yourdfpy", one.tree, ("link_bodies",), SEED, form="urdf", text=text)
        assert [found.cell.verdict for found in judged(OWN["yourdfpy"], job, Truths())] == [verdict]


def test_gravity_that_a_reader_leaves_out_shows_where_it_reads_no_masses() -> None:
    require("dartpy", "engine-dart")
    one = LINES["mjcf: gravity of unit masses"]
    job = Job("dart", one.tree, ("mass_matrix", "bias"), SEED, form="mjcf", text=one.text)
    cells = [found.cell for found in judged(OWN["dart"], job, Truths())]
    assert [cell.verdict for cell in cells] == ["right", "wrong"]
    assert next(cause.name for cause in stated() if cause.explains(cells[1])) == "gravity of MJCF"


@pytest.mark.parametrize("name", [name for name, tree in SINGLE.items() if tree.asked in ("wheels", "held distances")])
def test_newton_steps_lone_bodies(name: str) -> None:
    if not OWN["newton"].version():
        pytest.skip(needs_extra("engine-newton", "newton"))
    found = {cell.function: cell.verdict for cell in cells(OWN["newton"], SINGLE[name])}
    right = {function for function, verdict in found.items() if verdict in ("right", "precondition")}
    assert set(found) - right <= ({"step_of_wheel", "wheel_wrench"} if name in WRONG else set())


def test_a_drive_is_read_for_radians() -> None:
    one = usd.files()["usd: drive, angular"]
    ((joint,),) = (link.joints for link in one.tree.links)
    assert np.allclose(joint.drive, (2.0 * 180.0 / np.pi, 0.25 * 180.0 / np.pi, 0.5 * np.pi / 180.0))
    truth, point = _at(replace(one.tree, asked=""), HINGE)
    assert np.allclose(digits(truth.own.drives), [joint.drive]) and point is not None
