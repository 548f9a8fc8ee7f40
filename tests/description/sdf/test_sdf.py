"""SDFormat: Drake's numbers for the same files, a URDF of the same robot, loops, meshes; the rest is in sdf.txt."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from tests.description import reading
from tests.description.sdf.models import MODELS, document, link
from tests.models import interpreted

load = partial(reading.load, name="model.sdf")


@pytest.mark.parametrize("name", MODELS)
def test_drake_has_the_same_equations(tmp_path: Path, name: str) -> None:
    case = MODELS[name]
    model = interpreted(load(tmp_path, case.text))
    n = len(case.coordinates)
    order = [case.coordinates.index(coordinate) for coordinate in model.names.q]
    q, v, h = (np.array(values)[order] for values in (case.q, case.v, case.h))
    M = np.zeros((n, n))
    M[np.tril_indices(n)] = case.M
    M = (M + M.T - np.diag(np.diag(M)))[np.ix_(order, order)]
    # Poses of frames are products of a few rotations; measured: 2e-15 of the largest entry.
    np.testing.assert_allclose(model.mass_matrix(q), M, atol=1e-13 * np.abs(M).max())
    np.testing.assert_allclose(model.bias(q, v), h, atol=1e-13 * np.abs(h).max())


JOINT = '<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{inside}</joint>'
AXIS = "<axis><xyz>0 1 0</xyz>{}</axis>"


def joint(name: str, parent: str, child: str, inside: str = AXIS.format(""), kind: str = "revolute") -> str:
    return JOINT.format(name=name, kind=kind, parent=parent, child=child, inside=inside)


def test_links_that_no_joint_holds_float_as_a_urdf_with_a_floating_base(tmp_path: Path) -> None:
    sdf = link("a", "<pose>1 2 3 0 0 0</pose>", 2) + link("b", "<pose>1.5 2 3.1 0 0 0</pose>", 1)
    ours = interpreted(load(tmp_path, document(sdf + joint("q", "a", "b"))))
    inertial = (
        '<inertial><origin xyz="0.1 -0.05 0.2" rpy="0.3 0.1 -0.2"/><mass value="{}"/>'
        '<inertia ixx="0.2" iyy="0.3" izz="0.25" ixy="0.01" ixz="-0.02" iyz="0.03"/></inertial>'
    )
    urdf = "".join(f'<link name="{name}">{inertial.format(mass)}</link>' for name, mass in (("a", 2), ("b", 1)))
    urdf += '<joint name="q" type="continuous"><parent link="a"/><child link="b"/><origin xyz="0.5 0 0.1"/>'
    (tmp_path / "robot.urdf").write_text(f'<robot name="r">{urdf}<axis xyz="0 1 0"/></joint></robot>')
    theirs = interpreted(sf.load(tmp_path / "robot.urdf", floating_base=True))
    q, v = theirs.random_state(np.random.default_rng(0))
    np.testing.assert_allclose(ours.mass_matrix(q), theirs.mass_matrix(q), atol=1e-13)
    np.testing.assert_allclose(ours.bias(q, v), theirs.bias(q, v), atol=1e-12)
    assert any("float: 1 link (a)" in note for note in load(tmp_path, document(sdf + joint("q", "a", "b"))).notes)


def four_bar(kind: str, axis: str) -> str:
    """A quadrilateral whose last joint closes the loop."""
    links = link("a", "", 1) + link("b", "<pose>0 0 1 0 0.2 0</pose>", 1) + link("c", "<pose>1 0 0 0 0 0</pose>", 1)
    tree = joint("q1", "world", "a") + joint("q2", "a", "b") + joint("q3", "world", "c")
    placed = f'<pose relative_to="b">1 0 0 0.3 0 0</pose>{axis}'
    return document(links + tree + joint("last", "c", "b", placed, kind))


@pytest.mark.parametrize(
    ("kind", "axis", "conditions"),
    [
        ("revolute", '<axis><xyz expressed_in="__model__">0 1 0</xyz></axis>', 5),
        ("prismatic", "<axis><xyz>1 1 0</xyz></axis>", 5),
        ("ball", "", 3),
        ("fixed", "", 6),
    ],
)
def test_joints_that_close_loops_become_closures_that_the_file_satisfies(
    tmp_path: Path, kind: str, axis: str, conditions: int
) -> None:
    system = load(tmp_path, four_bar(kind, axis))
    model = interpreted(system)
    assert model.nc == conditions and model.names.q == ("q1", "q2", "q3")
    np.testing.assert_allclose(model.constraint(np.zeros(3)), 0.0, atol=1e-15)
    if kind == "revolute":
        # A planar four-bar keeps the one motion that it has.
        assert np.linalg.matrix_rank(model.constraint_jacobian(np.zeros(3)), tol=1e-9) == 2
    assert any("joints that close loops" in note for note in system.notes)


def test_springs_dampers_limits_and_mimics_are_read(tmp_path: Path) -> None:
    inside = (
        "<dynamics><damping>0.3</damping><spring_stiffness>5</spring_stiffness><spring_reference>0.2</spring_reference>"
        "</dynamics><limit><lower>-1</lower><upper>1e16</upper><effort>-1</effort><velocity>3</velocity></limit>"
    )
    follower = '<mimic joint="q1"><multiplier>2</multiplier><offset>0.5</offset><reference>0.1</reference></mimic>'
    body = link("a", "", 1) + link("b", "<pose>0 0 1 0 0 0</pose>", 1) + joint("q1", "world", "a", AXIS.format(inside))
    system = load(tmp_path, document(body + joint("q2", "a", "b", AXIS.format(follower))))
    model = interpreted(system)
    assert model.names.u == ("q1",)
    np.testing.assert_allclose(model.constraint([0.3, 2 * (0.3 - 0.1) + 0.5]), 0.0, atol=1e-15)
    np.testing.assert_allclose(model.generalized_force([0.3, 0.0], [2.0, 1.0], [0.0])[0], -5 * 0.1 - 0.3 * 2)
    first = system.body("a").joint
    assert first is not None and first.limits == sf.Limits(-1.0, None, 3.0, None)


def test_joints_that_mimic_each_other_in_a_cycle_are_refused(tmp_path: Path) -> None:
    body = link("a", "", 1) + link("b", "<pose>0 0 1 0 0 0</pose>", 1)
    leads = {name: AXIS.format(f'<mimic joint="{other}"/>') for name, other in (("q1", "q2"), ("q2", "q1"))}
    with pytest.raises(sf.DescriptionError, match="q2 -> q1 -> q2"):
        load(tmp_path, document(body + joint("q1", "world", "a", leads["q1"]) + joint("q2", "a", "b", leads["q2"])))


def test_gravity_of_a_link_can_be_switched_off(tmp_path: Path) -> None:
    off = link("a", "<gravity>false</gravity>", 2) + joint("q", "world", "a")
    model = interpreted(load(tmp_path, document(off)))
    np.testing.assert_allclose(model.bias([0.4], [0.0]), model.generalized_force([0.4], [0.0], [0.0]), atol=1e-13)


def test_meshes_lie_in_the_folder_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "part.stl").write_text("solid")
    (tmp_path / "inner").mkdir()
    mesh = '<visual name="v"><geometry><mesh><uri>{}</uri></mesh></geometry></visual>'
    for file, drawn in (("part.stl", 1), ("../part.stl", 0), ("/etc/passwd", 0), ("model://x/../part.stl", 0)):
        text = document(link("a", mesh.format(file), 1) + joint("q", "world", "a"))
        folder = tmp_path if drawn else tmp_path / "inner"
        assert len(load(folder, text).visuals.get("a", ())) == drawn, file
