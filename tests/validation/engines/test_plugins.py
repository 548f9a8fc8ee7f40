"""Plug-ins of engines that are extras: right where their engines are, skipped where those are not installed."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.late import needs_extra
from validation.engines.interface import Joint, Link, Tree, Unsupported
from validation.engines.matrix import asked, cells
from validation.engines.models import hostile, single, spacecraft, transformed
from validation.engines.models.covering import chains
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN

EXTRAS = (
    "adam",
    "casadi",
    "dart",
    "drake",
    "dynibo",
    "exudyn",
    "frax",
    "idyntree",
    "mjx",
    "mujoco-warp",
    "pybullet",
    "pykdl",
    "roboticstoolbox",
    "sapien",
    "symofros",
)


def _installed(engine: str) -> None:
    if not OWN[engine].version():
        extra = re.search(r"symofros\[([\w-]+)\]", OWN[engine].extra)
        pytest.skip(needs_extra(extra[1], engine) if extra else f"{engine} is not installed: {OWN[engine].extra}")


@pytest.mark.parametrize("engine", EXTRAS)
def test_an_engine_is_right_about_hinges_between_oblique_links(
    engine: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And writes no files where it runs."""
    _installed(engine)
    monkeypatch.chdir(tmp_path)
    found = cells(OWN[engine], tree_of("revolute x"), ("mass_matrix", "bias", "gravity", "link_poses"))
    verdicts = {cell.verdict for cell in found}
    # PyBullet keeps poses in single precision.
    assert verdicts <= {"right", "imprecise"}
    assert engine == "pybullet" or verdicts == {"right"}
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("engine", ("casadi", "dart", "drake", "symofros"))
@pytest.mark.parametrize("kind", ("ball", "planar", "helical oblique", "free", "universal"))
def test_joints_of_several_coordinates_match_their_charts(engine: str, kind: str) -> None:
    _installed(engine)
    functions = ("mass_matrix", "inverse_dynamics", "link_velocities", "link_poses")
    assert {cell.verdict for cell in cells(OWN[engine], tree_of(kind), functions)} == {"right"}


@pytest.mark.parametrize("what", ("mass", "inertia", "frame"))
def test_copies_of_drake_have_what_is_changed_in_a_context(what: str) -> None:
    """A plant's copy, and its default context, have the plant's defaults: what is changed is of the context."""
    _installed("drake")
    functions = ("mass_matrix:Clone", "bias:Clone", "potential_energy:Clone", "link_poses:Clone")
    found = cells(OWN["drake"], transformed.trees()[f"{what} changed"], (*functions, "link_poses:SetDefaultPositions"))
    assert [cell.verdict for cell in found] == ["right"] * 5


def test_steps_of_dart_continue_rotation_vectors_beyond_half_a_turn() -> None:
    _installed("dart")
    (tree,) = (one for name, one in chains.trees().items() if name.startswith("chain 43: free base, oblique gravity"))
    (cell,) = cells(OWN["dart"], tree, ("step_stiffness_implicit",))
    assert cell.verdict == "right"


def test_moments_about_the_origin_of_the_world_are_not_asked_of_bases_far_from_it() -> None:
    _installed("idyntree")
    found = cells(OWN["idyntree"], hostile.trees()["free base 10 km away"], ("mass_matrix", "mass_matrix:world"))
    assert [cell.verdict for cell in found] == ["right", "not offered"]


@pytest.mark.parametrize("engine", ("adam", "dynibo", "frax", "idyntree"))
def test_floating_bases_match_their_charts(engine: str) -> None:
    _installed(engine)
    functions = ("mass_matrix", "gravity", "coriolis_forces")
    found = {cell.function: cell for cell in cells(OWN[engine], tree_of("free"), functions)}
    if engine == "idyntree":  # Its gravity after another function is by that one's pose: a stated cause.
        assert "right by itself" in found.pop("gravity").words
    assert {cell.verdict for cell in found.values()} == {"right"}


@pytest.mark.parametrize("engine", EXTRAS)
def test_joints_that_an_engine_lacks_are_refused(engine: str) -> None:
    tree = Tree("ellipsoid", (Link("a", -1, (Joint("ellipsoid", radii=(0.3, 0.2, 0.4)),)),))
    answer = OWN[engine].build(tree)
    assert isinstance(answer, Unsupported)
    assert not answer.offered
    assert answer.reason


@pytest.mark.parametrize("kind", ("euler xyz", "mimic prismatic", "revolute unbounded", "ball"))
def test_casadi_differentiates_and_solves_right(kind: str) -> None:
    """All its functions: derivatives of forces by coordinates and speeds, along quaternions, too."""
    plugin = OWN["casadi"]
    assert {cell.verdict for cell in cells(plugin, tree_of(kind), tuple(plugin.functions))} <= {"right", "not offered"}


def test_mujoco_warp_stands_still_without_room_for_constraints() -> None:
    """The stated cause: with room for no rows the speeds stay as they are; as made by default scenes step right."""
    _installed("mujoco-warp")
    (cell,) = cells(OWN["mujoco-warp"], tree_of("revolute x"), ("step_dampers_implicit:njmax_0",))
    assert cell.verdict == "wrong"


@pytest.mark.parametrize(
    ("kind", "functions", "verdicts"),
    (
        ("revolute z", ("step_semi_implicit", "coriolis_forces", "link_velocities", "jacobian_local"), {"right"}),
        ("prismatic", ("step_semi_implicit", "forward_dynamics"), {"right"}),
        # The stated causes: friction that was not asked for, and armature that its model of Pinocchio leaves out.
        ("prismatic", ("step_semi_implicit:set_joint_properties",), {"wrong"}),
        ("revolute with armature", ("step_semi_implicit", "bias"), {"right"}),
        ("revolute with armature", ("mass_matrix", "forward_dynamics"), {"wrong"}),
    ),
)
def test_sapien_moves_right_but_for_its_stated_causes(
    kind: str, functions: tuple[str, ...], verdicts: set[str]
) -> None:
    _installed("sapien")
    assert {cell.verdict for cell in cells(OWN["sapien"], tree_of(kind), functions)} == verdicts


def test_basilisk_turns_right_by_every_set_of_parameters() -> None:
    _installed("basilisk")
    tree = single.trees()["rotations"]
    names = tuple(name for name in asked(OWN["basilisk"], tree) if name.startswith(("rotation", "attitude", "mrp")))
    assert {cell.verdict for cell in cells(OWN["basilisk"], tree, names)} == {"right"}


@pytest.mark.parametrize("name", ["spacecraft with sprung hinges in series", "spacecraft with wheels"])
def test_basilisk_moves_spacecraft_right(name: str) -> None:
    _installed("basilisk")
    found = cells(OWN["basilisk"], spacecraft.trees()[name])
    assert {cell.verdict for cell in found} == {"right", "not offered"}


def test_plugins_load_in_an_environment_of_an_engine_and_numpy() -> None:
    absent = "mpmath", "pydantic", "ruamel", "scipy", "sympy"
    load = f"import sys; sys.modules.update(dict.fromkeys({absent})); import validation.engines.plugins"
    subprocess.run([sys.executable, "-c", load], check=True, timeout=120)
