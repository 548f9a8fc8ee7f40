from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from reference_models import MODELS
from tests.validation.subjects import UNIT, URDF, pendulum, subject_of
from validation.adapters import ROUTES, Missing
from validation.adapters.mujoco import tree as mujoco
from validation.adapters.mujoco import urdf as mujoco_urdf
from validation.adapters.pinocchio import urdf as pinocchio_urdf
from validation.checking import Settings, check
from validation.contract.interface import Subject, Unsupported, UrdfSource

FEW = Settings(states=10)
FLAT = sf.Inertia(1.0, (0.1, 0, 0), (0.1, 0.1, 0.5))  # 0.5 > 0.1 + 0.1: no body has this.


def cross_and_rod(**cross: object) -> sf.System:
    """A universal joint: its cross is light, or has no mass at all."""
    return sf.System(
        "universal",
        [
            sf.RigidBody("cross", sf.Joint("a", "revolute", axis=(1, 0, 0)), **cross),
            sf.RigidBody("rod", sf.Joint("b", "revolute", "cross", axis=(0, 1, 0)), UNIT),
        ],
    )


def test_mujoco_has_no_massless_bodies_but_others_do() -> None:
    result = check(subject_of(cross_and_rod()), FEW)
    assert result.ok
    (row,) = (row for row in result.comparisons if row.engine == "mujoco")
    assert row.status == "unsupported" and row.note.startswith("body 'cross': mass and inertia")
    assert any(row.engine == "pinocchio" and row.status == "agree" for row in result.comparisons)


def test_mujoco_refuses_impossible_inertia_by_name() -> None:
    system = cross_and_rod(inertia=FLAT, waive=frozenset({"nonphysical_inertia"}))
    built = mujoco.build(subject_of(system))
    assert isinstance(built, Unsupported) and built.reason.startswith("body 'cross': inertia must satisfy")
    assert check(subject_of(system), FEW).ok


def test_a_massless_body_takes_the_mass_of_fixed_bodies() -> None:
    tool = sf.RigidBody("tool", sf.Joint("f", "fixed", "cross"), UNIT)
    built = mujoco.build(subject_of(cross_and_rod().with_bodies(tool)))
    assert not isinstance(built, Unsupported)


def test_a_missing_engine_is_a_row_with_the_remedy() -> None:
    factories = {"mujoco": Missing("No module named 'mujoco'; pip install")}
    result = check(subject_of(pendulum()), FEW, factories)
    (row,) = (row for row in result.comparisons if row.engine == "mujoco")
    assert row.status == "unsupported" and "pip install" in row.note
    assert result.ok


def test_a_check_without_engines_does_not_count_as_agreement() -> None:
    factories = {name: Missing("no") for name, route in ROUTES.items() if route.independent}
    result = check(subject_of(pendulum()), FEW, factories)
    assert not result.ok
    assert any(row.status == "failed" and "could be asked" in row.note for row in result.comparisons)


def test_our_own_interpreter_alone_may_be_asked_for() -> None:
    assert check(subject_of(pendulum()), replace(FEW, engines=("interpreted",))).ok


class TestUrdf:
    def subject(self, text: str, tmp_path: object) -> Subject:
        path = tmp_path / "robot.urdf"  # type: ignore[operator]
        path.write_text(text)
        system = sf.load(path)
        return Subject("robot", system, urdf=UrdfSource(text.encode(), sf.load(path, snap_tol=0.0)))

    @pytest.mark.parametrize("route", [pinocchio_urdf, mujoco_urdf])
    def test_models_not_read_from_a_file_are_unsupported(self, route: object) -> None:
        assert isinstance(route.build(subject_of(pendulum())), Unsupported)  # type: ignore[attr-defined]

    @pytest.mark.parametrize("route", [pinocchio_urdf, mujoco_urdf])
    def test_a_urdf_with_other_joints_is_refused(self, route: object, tmp_path: object) -> None:
        """A file with other joints than the description has."""
        subject = self.subject(URDF, tmp_path)
        assert subject.urdf is not None
        for text in (URDF.replace('name="s" type="prismatic"', 'name="s" type="fixed"'), URDF.replace('"s"', '"t"')):
            other = replace(subject, urdf=replace(subject.urdf, text=text.encode()))
            built = route.build(other)  # type: ignore[attr-defined]
            assert isinstance(built, Unsupported) and "its own reading" in built.reason

    def test_mujoco_leaves_no_log_behind(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: Any) -> None:
        """It has a remark on limits that coincide, and a habit of writing it into the current folder."""
        monkeypatch.chdir(tmp_path)
        text = URDF.replace('lower="-1" upper="1"', 'lower="0" upper="0"')
        assert not isinstance(mujoco_urdf.build(self.subject(text, tmp_path)), Unsupported)
        assert [path.name for path in tmp_path.iterdir()] == ["robot.urdf"]
        assert "limit" not in capfd.readouterr().err

    def test_inertia_without_mass_is_unsupported(self, tmp_path: object) -> None:
        """MuJoCo drops it when it fuses bodies; its answer would be another mechanism's."""
        foot = '<link name="foot"><inertial><mass value="0"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        foot += '</inertial></link><joint name="f" type="fixed"><parent link="slider"/><child link="foot"/></joint>'
        built = mujoco_urdf.build(self.subject(URDF.replace("</robot>", foot + "</robot>"), tmp_path))
        assert isinstance(built, Unsupported) and "'foot'" in built.reason


def test_a_prescribed_motion_is_refused() -> None:
    cart = sf.RigidBody("cart", sf.Joint("x", "prismatic", prescribed=True), sf.Inertia(1.0))
    rod = sf.RigidBody("rod", sf.Joint("q", "revolute", "cart"), sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1)))
    result = check(Subject("driven", sf.System("driven", [cart, rod])), Settings(states=5))
    assert not result.ok and "prescribed motion" in result.comparisons[0].note


@pytest.mark.slow
def test_an_engine_without_frames_is_not_asked_about_constraints() -> None:
    """Constraints are stated by an engine's own frames; one that has none says so, and the others go on."""

    class WithoutFrames:
        name, version, capabilities = "pinocchio", "1", frozenset({"mass_matrix"})

    result = check(Subject("four_bar", MODELS["four_bar"]), FEW, {"pinocchio": lambda subject: WithoutFrames()})
    (row,) = (row for row in result.comparisons if row.engine == "pinocchio")
    assert row.status == "unsupported" and "frames" in row.note and result.ok
