"""xacro: macros, properties and arguments make the URDF that they stand for; files are untrusted."""

from __future__ import annotations

from pathlib import Path

import pytest

import symofros as sf
from symofros.description.urdf import xacro_files, xacro_worker

pytest.importorskip("xacro")

INERTIAL = '<inertial><mass value="${{{mass}}}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
MACRO = (
    '<xacro:macro name="bar" params="name mass:=2 parent"><link name="${name}">'
    + INERTIAL.format(mass="mass*scale")
    + '</link><joint name="q_${name}" type="continuous"><parent link="${parent}"/><child link="${name}"/>'
    '<origin xyz="${sqrt(4)} 0 0" rpy="0 ${pi/2} 0"/><axis xyz="0 1 0"/></joint></xacro:macro>'
)


def write(folder: Path, inside: str, name: str = "arm.urdf.xacro") -> Path:
    path = folder / name
    path.write_text(
        f'<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base"/>{inside}</robot>'
    )
    return path


def faults(path: Path) -> str:
    with pytest.raises(sf.DescriptionError) as caught:
        sf.load(path)
    return str(caught.value)


def test_macros_properties_conditions_arguments_and_files(tmp_path: Path) -> None:
    (tmp_path / "values.yaml").write_text("scale: 3")
    write(tmp_path, MACRO, "macros.xacro")
    text = (
        '<xacro:arg name="second" default="false"/>'
        "<xacro:property name='values' value='${xacro.load_yaml(&quot;values.yaml&quot;)}'/>"
        '<xacro:property name="scale" value="${values[\'scale\']}"/><xacro:include filename="macros.xacro"/>'
        '<xacro:bar name="a" parent="base"/>'
        '<xacro:if value="$(arg second)"><xacro:bar name="b" mass="1" parent="a"/></xacro:if>'
    )
    path = write(tmp_path, text.replace('<link name="base"/>', ""))
    (tmp_path / "macros.xacro").write_text((tmp_path / "macros.xacro").read_text().replace('<link name="base"/>', ""))
    system = sf.load(path)
    assert [body.name for body in system.bodies] == ["base", "a"]
    inertia, joint = system.body("a").inertia, system.body("a").joint
    assert inertia is not None and inertia.mass == 6.0
    assert joint is not None and joint.position == (2.0, 0.0, 0.0)
    both = sf.load(path, arguments={"second": "true"})
    assert [body.name for body in both.bodies] == ["base", "a", "b"]


def test_files_of_the_package_are_found(tmp_path: Path) -> None:
    package = tmp_path / "robot_description"
    (package / "urdf").mkdir(parents=True)
    (package / "package.xml").write_text("<package/>")
    (package / "part.xacro").write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="scale" value="1"/></robot>'
    )
    include = '<xacro:include filename="$(find robot_description)/part.xacro"/>'
    path = write(package / "urdf", f'{include}{MACRO}<xacro:bar name="a" parent="base"/>')
    assert sf.load(path).body("a").name == "a"
    assert "packages other than that" in faults(write(package / "urdf", include.replace("robot_", "other_")))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("${().__class__.__bases__[0]}", "begin with '_'"),
        ("${().__class__.__bases__[0].__subclasses__()}", "may not be called"),
        ("${python.type(1)}", "'python.type' may not be called"),
        ("${'%s'.format(1)}", "may not be called"),
        ("${[x for x in range(9)]}", "ListComp is not allowed"),
        ("${lambda: 1}", "Lambda is not allowed"),
        ("$(eval [x for x in ''])", "ListComp is not allowed"),
        ("${xacro.load_yaml('../secret.yaml')}", "leaves the folder"),
        ("${xacro.load_yaml('/etc/passwd')}", "leaves the folder"),
        ("$(env HOME)", "environment variable"),
        ("${1 +}", "invalid syntax"),
        ("${nothing}", "nothing"),
    ],
)
def test_expressions_compute_and_do_nothing_else(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "secret.yaml").write_text("a: 1")
    quoted = text.replace("&", "&amp;").replace('"', "&quot;")
    message = faults(write(tmp_path / "inner", f'<link name="{quoted}"/>'))
    assert "xacro can't expand" in message and said in message, message


@pytest.mark.parametrize("where", ["../secret.xacro", "{outside}/secret.xacro", "link.xacro"])
def test_nothing_outside_of_the_folder_is_included(tmp_path: Path, where: str) -> None:
    folder = tmp_path / "inner"
    folder.mkdir()
    write(tmp_path, "", "secret.xacro")
    (folder / "link.xacro").symlink_to(tmp_path / "secret.xacro")
    text = f'<xacro:include filename="{where.format(outside=tmp_path)}"/>'
    assert "leaves the folder" in faults(write(folder, text))


def test_entities_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    path.write_text(f'<!DOCTYPE robot [<!ENTITY a "b">]>{path.read_text()}')
    assert "document types are refused" in faults(path)


def test_memory_and_time_are_bounded(tmp_path: Path) -> None:
    assert "Memory" in faults(write(tmp_path, '<link name="${len([0]*10**10)}"/>'))
    assert "it expands to" in faults(write(tmp_path, "<link name=\"${'a'*2*10**7}\"/>"))


def test_problems_of_the_urdf_name_lines_of_the_expanded_text(tmp_path: Path) -> None:
    message = faults(write(tmp_path, '<joint name="q" type="revolut"/>'))
    assert "arm.urdf.xacro (expanded):" in message and "did you mean 'revolute'" in message


def test_without_xacro_the_remedy_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xacro_files, "_answer", lambda task: {"absent": "xacro"})
    assert "pip install 'symofros[xacro]'" in faults(write(tmp_path, ""))


@pytest.mark.parametrize("expression", ["pi/2", "a.b['c'][0] if x > 1 and not y else -2**3", "max(1, radians(90))"])
def test_arithmetic_is_allowed(expression: str) -> None:
    xacro_worker.vet(expression)
