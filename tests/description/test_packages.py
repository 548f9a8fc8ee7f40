"""Folders that files of a description may be read from: its own, neighbours that say what they are, those named."""

from __future__ import annotations

from pathlib import Path

import pytest

import symofros as sf
from symofros.description.packages import Packages
from tests.description.reading import refused

ROBOT = '<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">{}</robot>'
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
FINGER = (
    f'<link name="base"/><link name="finger">{INERTIAL}</link><joint name="q" type="continuous">'
    '<parent link="base"/><child link="finger"/></joint>'
)
INCLUDE = '<xacro:include filename="$(find hand_description)/hand.xacro"/>'
BODY = '<worldbody><body><joint name="j"/><geom size=".1" pos="1 0 0"/></body></worldbody>'
MODEL = f'<mujoco><include file="{{}}"/>{BODY}</mujoco>'
DEFAULTS = '<mujoco><default><geom density="500"/></default></mujoco>'


def package(folder: Path, name: str, **files: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")
    for file, text in files.items():
        (folder / f"{file}.xacro").write_text(ROBOT.format(text))
    return folder / "arm.xacro"


def test_packages_of_a_workspace_are_found_by_their_manifests(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    main = package(tmp_path / "src/arm", "arm_description", arm=INCLUDE)
    package(tmp_path / "src/other_name", "hand_description", hand=FINGER)
    assert [body.name for body in sf.load(main).bodies] == ["base", "finger"]


def test_a_package_in_another_folder_is_opened_by_the_proposed_option(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    main = package(tmp_path / "src/arm", "arm_description", arm=INCLUDE)
    package(tmp_path / "elsewhere", "hand_description", hand=FINGER)
    error = refused(main)
    text = str(error)
    assert len(error.problems) == 1 and text.count("$(find hand_description)") == 1 and "<class" not in text
    assert "load(…, packages={'hand_description': 'FOLDER'})" in text
    assert "--package hand_description=FOLDER" in error.in_shell() and "load(" not in error.in_shell()
    assert sf.load(main, packages={"hand_description": tmp_path / "elsewhere"}).body("finger")
    assert "is not there" in str(refused(main, packages={"hand_description": tmp_path / "nowhere"}))


@pytest.mark.parametrize("how", ["link", "manifest", "above", "unnamed"])
def test_packages_outside_the_workspace_are_not_found(tmp_path: Path, how: str) -> None:
    """A link beside the package, or one for its manifest; a path that leaves a package that was found."""
    pytest.importorskip("xacro")
    include = INCLUDE if how != "above" else INCLUDE.replace("/hand.xacro", "/../../secret/hand.xacro")
    main = package(tmp_path / "src/arm", "arm_description", arm=include)
    secret = tmp_path / "secret"
    package(secret, "hand_description" if how != "above" else "secret", hand=FINGER)
    if how == "link":
        (tmp_path / "src/hand").symlink_to(secret)
    elif how == "manifest":
        (tmp_path / "src/hand").mkdir()
        (tmp_path / "src/hand/package.xml").symlink_to(secret / "package.xml")
        (tmp_path / "src/hand/hand.xacro").write_text(ROBOT.format(FINGER))
    elif how == "above":
        package(tmp_path / "src/hand", "hand_description")
    else:
        package(tmp_path / "src/hand", "", hand=FINGER)
    said = "leaves the folders" if how == "above" else "there is no package 'hand_description'"
    assert said in str(refused(main))


def test_packages_that_find_does_not_name_are_not_opened(tmp_path: Path) -> None:
    """Neighbours open when `$(find)` names them, and not before."""
    pytest.importorskip("xacro")
    plain = '<xacro:include filename="../hand/hand.xacro"/>'
    main = package(tmp_path / "src/arm", "arm_description", arm=plain)
    package(tmp_path / "src/hand", "hand_description", hand=FINGER)
    assert "leaves the folders" in str(refused(main))
    package(tmp_path / "src/arm", "arm_description", arm=INCLUDE)
    assert sf.load(main).body("finger")


def test_relative_xacro_includes_open_named_folders(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    main = package(tmp_path / "arm", "arm", arm='<xacro:include filename="../parts/hand.xacro"/>')
    package(tmp_path / "parts", "parts", hand=FINGER)
    error = refused(main)
    assert "name the folder that it lies in: load(…, packages={'NAME': 'FOLDER'})" in str(error)
    assert "--package NAME=FOLDER" in error.in_shell()
    assert sf.load(main, packages={"any": tmp_path / "parts"}).body("finger")


def test_a_fault_is_reported_once_with_its_place(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    text = str(refused(package(tmp_path / "arm", "arm", arm='<link name="${unknown * 2}"/>')))
    assert text.count("'unknown' is not defined") == 1 and "<class" not in text
    assert "evaluating expression 'unknown * 2'" in text


def test_meshes_of_packages_are_found(tmp_path: Path) -> None:
    mesh = '<visual><geometry><mesh filename="package://hand_description/a.stl"/></geometry></visual>'
    main = package(tmp_path / "src/arm", "arm_description")
    main = main.with_name("arm.urdf")
    main.write_text(ROBOT.format(FINGER.replace(INERTIAL, INERTIAL + mesh)))
    assert not sf.load(main).visuals
    package(tmp_path / "src/hand", "hand_description")
    (tmp_path / "src/hand/a.stl").write_text("solid")
    assert sf.load(main).visuals["finger"][0].file == str((tmp_path / "src/hand/a.stl").resolve())


def test_mjcf_reads_named_folders(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    for folder in ("arm", "common", "secret"):
        (tmp_path / folder).mkdir()
    main = tmp_path / "arm/arm.xml"
    main.write_text(MODEL.format("../common/defaults.xml"))
    (tmp_path / "common/defaults.xml").write_text(DEFAULTS)
    error = refused(main)
    assert len(error.problems) == 1
    common = str(tmp_path / "common")
    assert f"load(…, packages={{'common': '{common}'}})" in str(error)
    assert f"--package common={common}" in error.in_shell()
    inertia = sf.load(main, packages={"common": common}).bodies[-1].inertia
    assert inertia is not None and inertia.mass == pytest.approx(500 * 4 / 3 * 3.141592653589793 * 1e-3)
    # The folder that holds both does as well, and a link in it leads nowhere else.
    assert sf.load(main, packages={"all": tmp_path}).bodies
    (tmp_path / "common/defaults.xml").unlink()
    (tmp_path / "secret/defaults.xml").write_text(DEFAULTS)
    (tmp_path / "common/defaults.xml").symlink_to(tmp_path / "secret/defaults.xml")
    assert "leaves the model's folder" in str(refused(main, packages={"common": common}))


@pytest.mark.parametrize("file", ["/etc/passwd", "C:/x.xml", "..\\..\\x.xml", "../" * 40 + "etc/passwd", "x" * 5000])
def test_mjcf_does_not_leave_its_folder(tmp_path: Path, file: str) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "arm.xml").write_text(MODEL.format(file))
    assert len(refused(tmp_path / "arm.xml", packages={"here": tmp_path}).problems) == 1


def test_a_folder_without_a_model_has_no_neighbours(tmp_path: Path) -> None:
    """Beside a file of some folder all others would be open."""
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
    (tmp_path / "b/model.sdf").write_text("x")
    assert Packages(tmp_path / "a/x.sdf").model("b") is None
    (tmp_path / "a/model.config").write_text("x")
    assert Packages(tmp_path / "a/x.sdf").model("b") == (tmp_path / "b").resolve()


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("a.yaml", {"packages": {"a": "."}}),
        ("a.urdf", {"arguments": {"a": "b"}}),
        ("a.sdf", {"mimic": True}),
        ("a.xml", {"arguments": {"a": "b"}}),
        ("a.usda", {"packages": {"a": "."}}),
    ],
)
def test_arguments_that_a_format_has_no_use_for_are_refused(
    tmp_path: Path, name: str, given: dict[str, object]
) -> None:
    (tmp_path / name).write_text("")
    assert "files only" in str(refused(tmp_path / name, **given))


def test_manifests_are_read_only_on_demand_and_within_bounds(tmp_path: Path) -> None:
    """Neighbours of 1 MB each: 60 of them took a minute of a file that names none."""
    main = package(tmp_path / "src/arm", "arm_description", arm=FINGER)
    for i in range(70):
        package(tmp_path / f"src/n{i:02}", "x")
        (tmp_path / f"src/n{i:02}/package.xml").write_text("<p>" + "<a/>" * 20_000 + "<name>late</name></p>")
    package(tmp_path / "src/late", "late")
    packages = Packages(main)
    assert packages.of("arm_description") == packages.of("arm") == (packages.own,)
    assert packages.of("late") == ((tmp_path / "src/late").resolve(),)
    assert "neighbours" not in vars(packages) and packages._bytes < 1000
    assert packages.of("other") == () and 3 << 20 < packages._bytes <= 4 << 20


def test_two_neighbours_of_one_name_are_refused_unless_a_folder_decides(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    main = package(tmp_path / "src/arm", "arm_description", arm=INCLUDE)
    for folder in ("one", "two"):
        package(tmp_path / f"src/{folder}", "hand_description", hand=FINGER)
    text = str(refused(main))
    assert "'hand_description' is several packages" in text and "packages={'hand_description': 'FOLDER'}" in text
    assert all(f"'{tmp_path.resolve() / 'src' / folder}'" in text for folder in ("one", "two"))
    package(tmp_path / "src/hand_description", "hand_description", hand=FINGER.replace("finger", "thumb"))
    assert sf.load(main).body("thumb")


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("<package><name> a </name>", "a"),
        ("<package><x><name>b</name></x><name>a</name>", "a"),
        ("<!DOCTYPE p><package><name>a</name></package>", ""),
        ("<package><name>a", ""),
        ("<?xml version='1.0' encoding='no'?><package><name>a</name></package>", ""),
        ("<package></name>", ""),
        ("<name>a</name>", ""),
    ],
)
def test_package_names_are_read_from_the_start_of_manifests(tmp_path: Path, text: str, name: str) -> None:
    package(tmp_path / "arm", "arm_description")
    package(tmp_path / "folder", "")
    (tmp_path / "folder/package.xml").write_text(text)
    assert [*Packages(tmp_path / "arm/arm.xacro").neighbours] == [name] * bool(name)


def test_a_mesh_of_an_ambiguous_package_is_left_out_with_a_note(tmp_path: Path) -> None:
    mesh = '<visual><geometry><mesh filename="package://hand_description/a.stl"/></geometry></visual>'
    main = package(tmp_path / "src/arm", "arm_description").with_name("arm.urdf")
    main.write_text(ROBOT.format(FINGER.replace(INERTIAL, INERTIAL + mesh)))
    for folder in ("one", "two"):
        package(tmp_path / f"src/{folder}", "hand_description")
        (tmp_path / f"src/{folder}/a.stl").write_text("solid")
    system = sf.load(main)
    assert not system.visuals and any("src/one" in note and "src/two" in note for note in system.notes)
    assert any("packages of one name, of which none is taken" in note for note in system.notes)
    (tmp_path / "src/two/package.xml").unlink()
    alone = sf.load(main)
    assert alone.visuals and not any("of one name" in note for note in alone.notes)


@pytest.mark.parametrize("folder", ["a\0b", "x" * 5000])
def test_impossible_folders_are_refused_with_short_messages(tmp_path: Path, folder: str) -> None:
    (tmp_path / "a.urdf").write_text(ROBOT.format(FINGER))
    text = str(refused(tmp_path / "a.urdf", packages={"n" * 5000: folder}))
    assert "is not there" in text and "\0" not in text and len(text) < 1000
