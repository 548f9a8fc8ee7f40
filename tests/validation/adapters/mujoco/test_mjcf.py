"""MuJoCo's own reading of an MJCF file against our import of it, as `python -m validation check model.xml` does it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app as symofros_app
from symofros.commands.reading import ReadingOptions
from tests.description.mjcf.models import MODELS, document
from tests.models import sampled
from tests.validation.subjects import subject_of
from validation.__main__ import app
from validation.adapters.mujoco import mjcf as mujoco_mjcf
from validation.checking import ModelResult, Settings, check
from validation.contract.interface import Subject, Unsupported
from validation.contract.quantities import MJCF_ROUTE
from validation.inputs.cases import Case, named

FEW = Settings(states=8, engines=("mujoco-mjcf",))


def write(folder: Path, text: str) -> Path:
    path = folder / "model.xml"
    path.write_text(document(text))
    return path


def subject(folder: Path, text: str) -> Subject:
    return Case("model", write(folder, text)).load()


def compared(result: ModelResult) -> set[str]:
    return {row.quantity for row in result.comparisons if row.engine == "mujoco-mjcf" and row.status == "agree"}


@pytest.mark.parametrize(
    "name",
    sampled(
        ("several_joints_on_a_body", "ball_joint", "free_joint", "nameless"), ("several_joints_on_a_body", "free_joint")
    ),
)
def test_all_quantities_offered_by_mujoco_agree(tmp_path: Path, name: str) -> None:
    result = check(subject(tmp_path, MODELS[name]), FEW)
    assert result.ok, [row for row in result.comparisons if not row.ok]
    assert compared(result) == MJCF_ROUTE | {"motion_energy"}


@pytest.mark.parametrize(
    ("before", "after", "quantity"),
    [
        ('armature="0.1"', 'armature="0.2"', "mass_matrix"),
        ('ref="-0.6"', 'ref="-0.5"', "frame_pose"),
        ('pos="0.3 0 0"', 'pos="0.3 0.1 0"', "potential_energy"),
        ('axis="0 0 1"', 'axis="0 0 1" damping="1"', "generalized_force"),
        ('axis="0 0 1"', 'axis="0 0.1 1"', "bias"),
    ],
)
def test_a_changed_mechanism_is_detected(tmp_path: Path, before: str, after: str, quantity: str) -> None:
    """The file is changed behind our importer's back."""
    text = MODELS["several_joints_on_a_body"]
    ours = subject(tmp_path, text)
    assert before in text
    write(tmp_path, text.replace(before, after, 1))
    row = next(row for row in check(ours, FEW).comparisons if row.quantity == quantity)
    assert row.status == "disagree", row


IGNORED = """
    <option density="1000" viscosity="2"/>
    <worldbody><body name="a">
      <joint name="q1" axis="0 1 0" stiffness="1 2" damping="1 2 3"/><geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/>
      <body name="b" pos="1 0 0"><joint name="q2" type="ball" stiffness="5" damping="1 2"/><geom size="0.1"/></body>
    </body><body name="hand" mocap="true" pos="0 0 3"><geom size="1"/></body></worldbody>
    <tendon><fixed name="t" stiffness="9" damping="9" armature="9"><joint joint="q1" coef="2"/></fixed></tendon>
    <actuator><general joint="q1" armature="7" damping="7"/></actuator>"""


@pytest.mark.slow
def test_features_ignored_by_the_importer_are_not_disagreements(tmp_path: Path) -> None:
    result = check(subject(tmp_path, IGNORED), FEW)
    assert result.ok, [row for row in result.comparisons if not row.ok]
    assert compared(result) >= MJCF_ROUTE


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            '<worldbody><body><joint name="f" type="free" armature="1"/><geom size="1"/></body></worldbody>',
            "joint 'f': an armature along body axes",
        ),
    ],
)
def test_files_that_the_engine_cannot_represent_are_unsupported(tmp_path: Path, text: str, reason: str) -> None:
    built = mujoco_mjcf.build(subject(tmp_path, text))
    assert isinstance(built, Unsupported) and reason in built.reason


def test_a_file_that_became_unreadable_is_reported(tmp_path: Path) -> None:
    ours = subject(tmp_path, MODELS["radian"])
    write(tmp_path, "<worldbody><bdy/></worldbody>")
    built = mujoco_mjcf.build(ours)
    assert isinstance(built, Unsupported) and "its own reading of the file" in built.reason
    write(tmp_path, MODELS["ball_joint"])
    built = mujoco_mjcf.build(ours)
    assert isinstance(built, Unsupported) and built.reason == "3 joints, ours has 1"


@pytest.mark.slow
def test_models_not_read_from_mjcf_are_unsupported() -> None:
    rod = sf.RigidBody("rod", sf.Joint("q", "revolute"), sf.Inertia(1.0, (1, 0, 0), (1, 1, 1)))
    pendulum = subject_of(sf.System("pendulum", [rod]))
    assert isinstance(mujoco_mjcf.build(pendulum), Unsupported)
    assert not [row for row in check(pendulum, replace(FEW, engines=None)).comparisons if row.engine == "mujoco-mjcf"]


@pytest.mark.slow
def test_the_command_line_checks_mjcf_files_unless_options_change_their_reading(tmp_path: Path) -> None:
    path = write(tmp_path, MODELS["reference_and_spring_reference"])
    # Where it is read with other joints or forces than it states, MuJoCo's own reading is no second opinion.
    for reading in (ReadingOptions(True), ReadingOptions(dissipation="none"), ReadingOptions(limits="stops")):
        assert named([str(path)], reading) == [Case("model", path, reading)]
        assert Case("model", path, reading).load().mjcf is None
    run = CliRunner().invoke(app, ["check", str(path), "--states", "5", "--json", "--report", str(tmp_path / "r")])
    rows = json.loads(run.stdout)["comparisons"]
    assert run.exit_code == 0, run.stdout
    assert {"pinocchio", "mujoco", "mujoco-mjcf"} <= {row["engine"] for row in rows}
    info = CliRunner().invoke(symofros_app, ["info", str(path), "--json"])
    assert json.loads(info.stdout)["nv"] == 2
