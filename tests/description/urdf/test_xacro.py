"""xacro: macros, properties and arguments make the URDF that they stand for; files are untrusted."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from symofros.description.packages import Packages
from symofros.description.urdf import xacro_expressions, xacro_files, xacro_worker
from tests.description.reading import faults
from tests.late import require

require("xacro", "xacro")

INERTIAL = '<inertial><mass value="${{{mass}}}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
MACRO = (
    '<xacro:macro name="bar" params="name mass:=2 parent"><link name="${name}">'
    + INERTIAL.format(mass="mass*scale")
    + '</link><joint name="q_${name}" type="continuous"><parent link="${parent}"/><child link="${name}"/>'
    '<origin xyz="${sqrt(4)} 0 0" rpy="0 ${pi/2} 0"/><axis xyz="0 1 0"/></joint></xacro:macro>'
)
ARM = '<xacro:bar name="a" parent="base"/>'


def write(folder: Path, inside: str, name: str = "arm.urdf.xacro") -> Path:
    path = folder / name
    path.write_text(
        f'<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base"/>{inside}</robot>'
    )
    return path


def test_xacro_macros_properties_conditions_arguments_and_files_are_expanded(tmp_path: Path) -> None:
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
    assert "there is no package 'other_description'" in faults(
        write(package / "urdf", include.replace("robot_", "other_"))
    )
    # A clone's folder may have another name than the package that its package.xml states.
    (package / "package.xml").write_text("<package><name>other_description</name></package>")
    assert sf.load(write(package / "urdf", include.replace("robot_", "other_") + MACRO + ARM)).body("a").name == "a"


# Expressions, and what refusing them says.
REFUSED = [tuple(line.split(" => ")) for line in Path(__file__).with_name("xacro_refused.txt").read_text().splitlines()]
REFUSED += [
    ("${" + "(" * 150 + "-" * 150 + "1" + ")" * 150 + "}", "deep"),
    (r"${'\ud800'}", "half of a surrogate pair"),
    (r"${xacro.fatal('\ud800\x1b[31m')}", r"fatal: \ud800\u001b[31m"),
]


@pytest.mark.parametrize(("text", "said"), REFUSED)
def test_expressions_beyond_computation_are_refused(tmp_path: Path, text: str, said: str) -> None:
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
    assert "leaves the folders" in faults(write(folder, text))


def test_entities_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    path.write_text(f'<!DOCTYPE robot [<!ENTITY a "b">]>{path.read_text()}')
    assert "document types are refused" in faults(path)


@pytest.mark.slow
def test_memory_and_time_of_xacro_are_bounded(tmp_path: Path) -> None:
    assert "more than 16777216" in faults(write(tmp_path, '<link name="${len([0]*10**10)}"/>'))
    lists = "+".join(["[[0]*10**7]"] * 30)  # 80 MB each
    assert "Memory" in faults(write(tmp_path, f'<link name="${{len({lists})}}"/>'))
    assert "it expands to" in faults(write(tmp_path, "<link name=\"${'a'*10**7}${'a'*10**7}\"/>"))


def test_problems_of_the_urdf_name_lines_of_the_expanded_text(tmp_path: Path) -> None:
    message = faults(write(tmp_path, '<joint name="q" type="revolut"/>'))
    assert "arm.urdf.xacro (expanded):" in message and "did you mean 'revolute'" in message


def test_without_xacro_the_remedy_names_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xacro_files, "_answer", lambda task: {"absent": "xacro"})
    assert "pip install 'symofros[xacro]'" in faults(write(tmp_path, ""))


@pytest.mark.parametrize(
    ("name", "value"),
    [("abs", "python.type"), ("len", "python.vars"), ("str", "python.map"), ("load_yaml", "xacro.load_yaml")],
)
def test_property_names_do_not_become_functions(tmp_path: Path, name: str, value: str) -> None:
    """A property with the name of a function neither holds a function nor replaces it."""
    text = f'<xacro:property name="{name}" value="${{{value}}}"/><link name="${{{name}}}"/>'
    assert "is no value of an expression" in faults(write(tmp_path, text))
    joint = '<joint name="j" type="continuous"><parent link="base"/><child link="l7"/></joint>'
    inertial = INERTIAL.format(mass="len([1])")
    text = f'<xacro:property name="{name}" value="7"/><link name="l${{max(0, {name})}}">{inertial}</link>{joint}'
    path = write(tmp_path, text)
    assert sf.load(path).body("l7").name == "l7"


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("pi/2", math.pi / 2),
        ("a['c'][0] if x > 1 and not y else -2**3", 5),
        ("a['c'][0] if 0 < x < 1 or y else -2**3", -8),
        ("max(1, radians(90))", math.pi / 2),
        ("math.hypot(3, 4) + python.len(a)", 6.0),
        ("'left_arm'.split('_')[0].upper() + '%02d' % x", "LEFT03"),
        ("a.get('b', 'none')", "none"),
        ("tokenize('1, 2;3')[1:]", ["2", "3"]),
        ("x is None or 3 in [x] and range(2) == [0, 1]", True),
        ("sorted((3, 1), reverse=True) + list(zip([1], [2]))", [3, 1, (1, 2)]),
    ],
)
def test_expressions_are_arithmetic(expression: str, value: object) -> None:
    symbols = {**xacro_expressions.CONSTANTS, "a": {"c": [5]}, "x": 3, "y": False}

    class Namespace(dict[str, object]):
        pass

    assert xacro_expressions.Evaluator(symbols, {}, Namespace)(expression) == value


@pytest.mark.parametrize("expression", ["'%(a)99999s' % {'a': 1}", "'%*d' % (9999, 1)", "round(1, -10**9)", "1 << 9"])
def test_operations_with_huge_results_are_refused(expression: str) -> None:
    with pytest.raises(xacro_expressions.Refusal):
        xacro_expressions.Evaluator({}, {}, frozenset)(expression)


def test_optional_files_may_be_missing(tmp_path: Path) -> None:
    include, text = '<xacro:include filename="absent.xacro"', '<xacro:property name="scale" value="1"/>' + MACRO + ARM
    assert sf.load(write(tmp_path, f'{include} optional="true"/>{text}')).body("a").name == "a"
    assert "No such file" in faults(write(tmp_path, f"{include}/>{text}"))


def test_constants_take_precedence_over_arguments_in_eval(tmp_path: Path) -> None:
    """As xacro does: an argument called `e` is not the `e` of $(eval ...)."""
    text = '<xacro:arg name="e" default="7"/><xacro:arg name="m" default="2"/><xacro:property name="scale" value="1"/>'
    bar = '<xacro:bar name="a" parent="base" mass="$(eval m*e)"/>'
    inertia = sf.load(write(tmp_path, text + MACRO + bar)).body("a").inertia
    assert inertia is not None and inertia.mass == 2 * math.e


def test_warnings_use_bounded_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each call of the macro warns of an attribute with a name of 10^5 letters."""
    kept: list[int] = []
    run = subprocess.run

    def counted(*args: Any, **options: Any) -> Any:
        done = run(*args, **options)
        kept.append(len(done.stdout or b"") + len(done.stderr or b""))
        return done

    monkeypatch.setattr(subprocess, "run", counted)
    warned = f'<xacro:macro name="w"><xacro:property name="q" value="1" {"a" * 10**5}="1"/></xacro:macro>'
    text = warned + "<xacro:w/>" * 50 + '<xacro:property name="scale" value="1"/>' + MACRO + ARM
    assert sf.load(write(tmp_path, text)).body("a").name == "a"
    assert kept[0] < 10**4


def worker(code: str) -> str:
    """What a script says that has the worker as `worker`, under bounds of its own."""
    load = f"import runpy; worker = runpy.run_path({xacro_worker.__file__!r})\n"
    return subprocess.run([sys.executable, "-I", "-c", load + code], capture_output=True, text=True).stdout


def test_existing_resource_limits_are_kept() -> None:
    """A process that has less memory than the worker's bound can't raise it, and is to work all the same."""
    pytest.importorskip("resource")
    code = "import resource\nresource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30))\nworker['bound']()\n"
    assert worker(code + "print(resource.getrlimit(resource.RLIMIT_AS))") == f"({2**30}, {2**30})\n"


@pytest.mark.parametrize("attempt", ["open(0)", "os.open(here + '/a', os.O_WRONLY)", "open(here + '/a', 'r+')"])
def test_the_guard_blocks_descriptors_and_writing(tmp_path: Path, attempt: str) -> None:
    (tmp_path / "a").write_text("a")
    code = (
        f"import os; here = {str(tmp_path.resolve())!r}; os.chdir(here); worker['guard']([here]); open('a').close()\n"
    )
    attempted = f"try: {attempt}\nexcept Exception as refusal: print(refusal)"
    assert "leaves the folders" in worker(code + attempted)


LIBRARY = Path(__file__).with_name("library.xacro").read_text()
USES = Path(__file__).with_name("uses.xacro").read_text()


def test_trusted_files_expand_as_in_xacro(tmp_path: Path) -> None:
    """Macros, blocks, defaults, forwarding, scopes, lazy properties, namespaces, conditions, YAML with units."""
    (tmp_path / "library.xacro").write_text(LIBRARY)
    (tmp_path / "values.yaml").write_text("arm: {length: 0.7, joints: [{limit: !degrees 90}]}\nangle: !degrees pi*10")
    (tmp_path / "robot.xacro").write_text(USES)
    file = str((tmp_path / "robot.xacro").resolve())
    code = "import sys, xacro; print(xacro.process_file(sys.argv[1], mappings={'n': '4'}).toprettyxml(indent=' '))"
    theirs = subprocess.run([sys.executable, "-c", code, file], capture_output=True, text=True, check=True).stdout
    ours = xacro_files.expanded(file, {"n": "4"}, Packages(Path(file))).decode()
    assert 'name="right_y_T"' in ours and "<never" not in ours
    assert ours.split() == theirs.split()


ROBOT = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}<link name="base"/></robot>'


def test_an_argument_that_no_file_has_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "robot.xacro"
    path.write_text(ROBOT.format('<xacro:arg name="lenght" default="1"/>'))
    with pytest.raises(sf.DescriptionError, match=r"no <xacro:arg> is called 'length'; there are: lenght"):
        sf.load(path, arguments={"length": "2"})


def test_pipes_are_not_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    path = tmp_path / "robot.xacro"
    for inside in ('<xacro:include filename="pipe"/>', '<xacro:property name="a" value="${load_yaml(\'pipe\')}"/>${a}'):
        path.write_text(ROBOT.format(inside))
        with pytest.raises(sf.DescriptionError, match="is no regular file"):
            sf.load(path)


@pytest.mark.parametrize("text", ["a: &a [*a]", "a0: &a0 [1, 2]\n{}"])
def test_expansion_of_aliases_is_bounded(tmp_path: Path, text: str) -> None:
    more = "".join(f"a{k + 1}: &a{k + 1} [{', '.join([f'*a{k}'] * 10)}]\n" for k in range(9))
    (tmp_path / "data.yaml").write_text(text.format(more))
    path = tmp_path / "robot.xacro"
    path.write_text(ROBOT.format("""<xacro:property name="a" value="${load_yaml('data.yaml')}"/>${a}"""))
    with pytest.raises(sf.DescriptionError, match="aliases written out"):
        sf.load(path)
    (tmp_path / "data.yaml").write_text("a: &a [1, 2]\nb: [*a, *a]\n")
    path.write_text(ROBOT.format("""<xacro:property name="a" value="${load_yaml('data.yaml')}"/>"""))
    with pytest.raises(sf.DescriptionError, match="moves|no joint|nothing|joint"):
        sf.compile(sf.load(path))
