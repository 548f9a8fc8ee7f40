"""Hostile files, each read in a process of its own: refused, in bounded time and memory, and nothing is run.

The bounds are far above what any case needs: they catch what hangs or swells, on the slowest machine.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from subprocess import PIPE
from threading import Timer
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from symofros.description.yaml import files, yaml_nodes
from symofros.errors import MAX_PROBLEMS
from tests.description.reading import faults
from tests.models import sampled

SECONDS = 120.0
# The reading process sees the packages that this one does, from another folder.
_ROOT = str(Path(sf.__file__).parent.parent)
MEBIBYTES = 700
EVERYTHING = Path(__file__).parents[3] / "validation" / "corpus" / "everything.yaml"

# A process that has the readers ready, their validators too, forks one process a file, whose memory is its own.
_READERS = Path(__file__).with_name("readers.py.in").read_text()


def body(name: str, parent: str = "world", mass: str = "1") -> str:
    return (
        f"  {name}: {{joint: {{name: q_{name}, kind: revolute, parent: {parent}}}, "
        f"inertia: {{mass: {mass}, moments: [1, 1, 1]}}}}\n"
    )


def formula(text: str) -> str:
    return "symofros: 1\nbodies:\n" + body("a", mass=json.dumps(text))


def bodies(*lines: str) -> str:
    return "symofros: 1\nbodies:\n" + "".join(lines)


def link(name: str) -> str:
    return f'<link name="{name}"/>'


def joint(name: str, parent: str, child: str) -> str:
    return f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'


XML_BOMB = (
    '<!DOCTYPE r [<!ENTITY a0 "x">'
    + "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 12))
    + ']><robot name="&a11;"/>'
)
YAML_BOMB = "a0: &a0 [x]\n" + "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 12))

# Name -> (suffix, content, what the message says).
CASES: dict[str, tuple[str, Callable[[], str], str]] = {
    "code": ("yaml", lambda: formula("__import__('os').system('touch ran')"), "'__import__' is not a legal name"),
    "tower": ("yaml", lambda: formula("9**9**9"), "not a finite number"),
    "long formula": ("yaml", lambda: formula("1+" * 1_900_000 + "1"), "longer than 10000 characters"),
    "deep formula": ("yaml", lambda: formula("(" * 4900 + "1" + ")" * 4900), "nested deeper than 100"),
    "deep lists": ("yaml", lambda: "symofros: " + "[" * 5000 + "]" * 5000, "nested deeper than 50"),
    "deep mappings": ("yaml", lambda: "{a: " * 5000 + "1" + "}" * 5000, "nested deeper than 50"),
    "unclosed lists": ("yaml", lambda: "[" * 1_000_000, "nested deeper than 50"),
    "billion laughs": ("yaml", lambda: YAML_BOMB, "anchors and aliases are refused"),
    "merge keys": ("yaml", lambda: "symofros: 1\nsystem: {<<: {name: a}}\n", "merge keys are refused"),
    "tag": ("yaml", lambda: "symofros: !!python/object/apply:os.system ['touch ran']", "tags are refused"),
    "bodies without number": ("yaml", lambda: bodies(*(f"  b{i}:\n" for i in range(10_001))), "at most 10000"),
    "parameters without number": (
        "yaml",
        lambda: "symofros: 1\nparameters:\n" + "".join(f"  p{i}: 1\n" for i in range(220_000)),
        "too many values",
    ),
    "faults without number": (
        "yaml",
        lambda: bodies(*(body(f"b{i}", f"c{i}") for i in range(1000))),
        "there are more faults than are listed",
    ),
    "wrong entries without number": (
        "yaml",
        lambda: bodies(*(f"  b{i}: {{jont: 1}}\n" for i in range(2000))),
        "there are more faults",
    ),
    "a cycle of thousands": (
        "yaml",
        lambda: bodies(*(body(f"b{i}", f"b{(i + 1) % 1000}") for i in range(1000))),
        "1000 bodies",
    ),
    "duplicates without number": ("yaml", lambda: "symofros: 1\n" * 5000, "appears twice"),
    "NUL": ("yaml", lambda: formula("1").replace("mass", "ma\0ss"), "not YAML"),
    "NUL by escape": ("yaml", lambda: formula("1").replace("a:", '"a\\0b":', 1), "unusable name"),
    "gigantic": ("yaml", lambda: "# " + "x" * (5 << 20), "too large"),
    "entities": ("urdf", lambda: XML_BOMB, "document types are refused"),
    "outer entity": (
        "urdf",
        lambda: '<!DOCTYPE r [<!ENTITY a SYSTEM "/etc/passwd">]><robot name="&a;"/>',
        "document types",
    ),
    "deep elements": ("urdf", lambda: '<robot name="r">' + "<a>" * 5000 + "</a>" * 5000, "nested deeper than 100"),
    "links without number": (
        "urdf",
        lambda: '<robot name="r">' + "".join(link(f"l{i}") for i in range(10_001)) + "</robot>",
        "too many links",
    ),
    "wrong joints without number": (
        "urdf",
        lambda: (
            '<robot name="r">'
            + "".join(link(f"l{i}") + joint(f"j{i}", "l0", f"c{i}") for i in range(5000))
            + "</robot>"
        ),
        "there are more faults",
    ),
    "NUL in XML": ("urdf", lambda: '<robot name="r\0"/>', "not well-formed"),
    "gigantic XML": ("urdf", lambda: '<robot name="r">' + " " * (17 << 20) + "</robot>", "too large"),
}


@pytest.fixture(scope="module")
def readers() -> Iterator[Callable[[Path], tuple[str, float]]]:
    """File -> what its reading process answers, and the most memory [MiB] that it took."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([_ROOT, *filter(None, sys.path)])}
    command = [sys.executable, "-c", _READERS, str(EVERYTHING)]
    with subprocess.Popen(
        command, stdin=PIPE, stdout=PIPE, text=True, env=environment, start_new_session=True
    ) as server:
        assert server.stdin and server.stdout

        def read(path: Path) -> tuple[str, float]:
            late = Timer(SECONDS, lambda: os.killpg(server.pid, signal.SIGKILL))
            late.start()
            server.stdin.write(json.dumps([str(path.parent), path.name]) + "\n")
            server.stdin.flush()
            answer = server.stdout.readline()
            late.cancel()
            assert answer, f"the process that reads ended without an answer, or took more than {SECONDS:g} s"
            text, peak = json.loads(answer)
            return text, peak

        yield read
        server.stdin.close()


# 220 000 values take four seconds; `test_documents_with_too_many_values_are_refused` has the same limit, smaller.
@pytest.mark.parametrize("name", sampled(tuple(CASES), [name for name in CASES if name != "parameters without number"]))
def test_hostile_files_are_refused_in_bounded_time_and_memory(name: str, readers: Any, tmp_path: Path) -> None:
    suffix, content, part = CASES[name]
    path = tmp_path / f"hostile.{suffix}"
    path.write_text(content())
    answer, peak = readers(path)
    assert part in answer, answer[:1000]
    assert peak < MEBIBYTES
    # Nothing ran, and whatever the size of the file, the message is one that can be read.
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    assert len(answer) < 100_000 and answer.count("  rule:") <= MAX_PROBLEMS + 1


SOUND = EVERYTHING.read_text()


@settings(max_examples=25)
@given(
    at=st.integers(0, len(SOUND)),
    length=st.integers(0, 40),
    put=st.text(max_size=20) | st.sampled_from(["{", "[", ": ", "\n", "&a", "!!x", "1e999", "q", "- ", "'", "#"]),
)
def test_a_changed_file_is_read_or_refused(
    at: int, length: int, put: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "changed.yaml"
    path.write_bytes((SOUND[:at] + put + SOUND[at + length :]).encode("utf-8", "surrogatepass"))
    try:
        system = sf.load(path)
    except sf.DescriptionError as error:
        assert error.problems and all(problem.what and problem.rule for problem in error.problems)
        assert all(problem.where.startswith(str(path)) for problem in error.problems if problem.where)
    else:
        sf.save(system, path.with_name("again.yaml"))
        assert sf.load(path.with_name("again.yaml")) == system


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
@pytest.mark.parametrize("name", ["pipe.yaml", "pipe.urdf"])
def test_a_pipe_does_not_block_the_reader(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / name)
    text = faults(tmp_path / name)
    assert "can't be read" in text and "a named pipe" in text
    (tmp_path / "main.yaml").write_text("symofros: 1\ninclude: [pipe.yaml]\n")
    if name == "pipe.yaml":
        assert "it is a named pipe" in faults(tmp_path / "main.yaml")


def test_included_files_share_the_limit_on_length(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A hundred files of the largest size would be read for an hour."""
    part = "symofros: 1\n# " + "x" * 300 + "\n"
    for i in range(5):
        (tmp_path / f"part{i}.yaml").write_text(part)
    (tmp_path / "main.yaml").write_text("symofros: 1\ninclude: [part0.yaml, part1.yaml, part2.yaml, part3.yaml]\n")
    monkeypatch.setattr(files, "MAX_BYTES", 1000)
    assert "'part3.yaml' is too large" in faults(tmp_path / "main.yaml").replace(f"{tmp_path}{os.sep}", "")


@pytest.mark.parametrize("suffix", ["yaml", "urdf", "xml", "sdf", "usda"])
def test_loops_of_symbolic_links_are_refused(suffix: str, tmp_path: Path) -> None:
    """Path.resolve raises RuntimeError of them before Python 3.13."""
    loop = tmp_path / f"loop.{suffix}"
    loop.symlink_to(loop.name)
    with pytest.raises(sf.DescriptionError, match="can't be read\\n  found:  a link that leads nowhere"):
        sf.load(loop)
    if suffix == "yaml":
        (tmp_path / "main.yaml").write_text("symofros: 1\ninclude: [loop.yaml]\n")
        with pytest.raises(sf.DescriptionError, match=r"loop.yaml"):
            sf.load(tmp_path / "main.yaml")
        with pytest.raises(sf.DescriptionError):
            sf.load_diagram(loop)


def test_documents_with_too_many_values_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(yaml_nodes, "MAX_NODES", 100)
    (tmp_path / "a.yaml").write_text("symofros: 1\nsystem: [" + "1, " * 200 + "]\n")
    assert "too many values" in faults(tmp_path / "a.yaml")


def test_a_long_chain_of_links_is_read_in_linear_time(tmp_path: Path) -> None:
    """Systems, each with a copy of all lines, are made a few times, not once a link."""
    made = []
    initialize = sf.System.__post_init__

    def counted(system: sf.System) -> None:
        made.append(len(system.origin))
        initialize(system)

    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="9" ixy="0" ixz="0" iyz="0"/></inertial>'
    links = "".join(f'<link name="l{i}">{inertial}</link>' for i in range(50))
    joints = "".join(joint(f"j{i}", f"l{i - 1}", f"l{i}").replace("fixed", "continuous") for i in range(1, 50))
    (tmp_path / "a.urdf").write_text(f'<robot name="r">{links}{joints}</robot>')
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sf.System, "__post_init__", counted)
        system = sf.load(tmp_path / "a.urdf")
    assert len(made) < 10
    assert all(body.waive == ("nonphysical_inertia",) for body in system.bodies[1:])


def test_a_long_chain_is_checked_in_linear_time() -> None:
    """Each body's mass was once summed by a walk to the root."""
    chain = [sf.RigidBody(f"b{i}", sf.Joint(f"q{i}", "revolute", f"b{i - 1}" if i else "world")) for i in range(3000)]
    chain[-1] = sf.RigidBody("b2999", chain[-1].joint, sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    from symofros.mechanics.topology.events import find_problems

    assert find_problems(sf.System("chain", chain)) == []
    assert len(find_problems(sf.System("chain", chain[:-1]))) == MAX_PROBLEMS + 1
