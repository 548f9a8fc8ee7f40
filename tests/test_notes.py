"""The register of notes: what the project remarks upon, each with a test that hears it and one where it is silent.

A note is a claim about a run, a file or an export, and one that cries wolf is a fault like one that is missing. What
the sources can say is read from their text. Each sentence has to be quoted by a test; silent are they all of runs that
are right (tests/simulation/results/examination/test_quiet_runs.py), and of files and exports that lack nothing, below.
"""

from __future__ import annotations

import ast
import re
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import symofros as sf
from reference_models import MODELS
from symofros.simulation.results.notes import NOTES

ROOT = Path(__file__).parents[1]
# Names of what collects notes, and of functions that return them in words.
COLLECTED, RETURNED = ("notes", "remarks"), re.compile(r"note|_lost$|_remark")
# The same where names differ: a beam's bending, a run that ends otherwise, starts that change, blocks in Python.
ELSEWHERE = {
    "beams.py": re.compile(r"^__str__$"),
    "starts.py": re.compile(r"^changes$|^singular_start$"),
    "python_blocks.py": re.compile(r"^fault$"),
}
# Letters in a row that tell one sentence from others.
TELLING = 10
# In place of what a sentence is about.
HOLE = "\0"


def sentence(node: ast.expr) -> str:
    """A literal text, with holes; "" of anything else."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else HOLE for part in node.values)
    if isinstance(node, ast.IfExp):
        return sentence(node.body) or sentence(node.orelse)
    if isinstance(node, ast.BinOp):
        return sentence(node.left) + HOLE + sentence(node.right)
    return ""


def collects(node: ast.AST) -> bool:
    """Whether it adds to what is collected: `self.notes.append(...)`, `remarks.add(...)`."""
    if not (
        isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in ("append", "add")
    ):
        return False
    holder = node.func.value
    return (getattr(holder, "attr", "") or getattr(holder, "id", "")) in COLLECTED


def sentences(node: ast.expr) -> Iterator[str]:
    """The literal text of a value, or those in a collection or a comprehension."""
    inner = node.args[0] if isinstance(node, ast.Call) and node.args else node
    values = [node, *getattr(inner, "elts", ())]
    values += [inner.elt] if isinstance(inner, ast.GeneratorExp | ast.ListComp) else []
    yield from (sentence(value) for value in values)


def of_function(node: ast.FunctionDef) -> Iterator[str]:
    """What it returns in words."""
    for inner in ast.walk(node):
        if isinstance(inner, ast.Return) and inner.value is not None:
            yield from sentences(inner.value)


def said_by(node: ast.AST, functions: re.Pattern[str]) -> list[str]:
    """The notes in words that a statement, a call or a function adds, passes on, or returns."""
    if collects(node):
        assert isinstance(node, ast.Call)
        return [sentence(node.args[0])]
    if isinstance(node, ast.FunctionDef) and functions.search(node.name):
        return list(of_function(node))
    if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") in ("note", "notes"):
        return list(sentences(node.value))
    return list(sentences(node.value)) if isinstance(node, ast.keyword) and node.arg == "notes" else []


@cache
def register() -> dict[str, str]:
    """Sentence -> file of the sources that says it."""
    found: dict[str, str] = {}
    for path in sorted((ROOT / "symofros").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if re.search("[Nn]ote|remark|_lost|Message", text) else ():
            for one in said_by(node, ELSEWHERE.get(path.name, RETURNED)):
                if max(map(len, one.split(HOLE)), default=0) >= TELLING:
                    found.setdefault(one, path.relative_to(ROOT).as_posix())
    return found


@cache
def expected() -> tuple[str, ...]:
    """Every literal text of the tests, and every line of their golden files, that may tell a note."""
    golden = [line.strip() for path in (ROOT / "tests").rglob("*.txt") for line in path.read_text("utf-8").splitlines()]
    texts = {line for line in golden if len(line) >= TELLING}
    for path in (ROOT / "tests").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.expr):
                texts |= {part for part in sentence(node).split(HOLE) if len(part) >= TELLING}
    return tuple(texts)


def tells(text: str, note: str) -> bool:
    """Whether a text of a test quotes a note, or a part of it: both are compared by a part without holes."""
    return any(len(part) >= TELLING and (part.strip() in text or text in part) for part in note.split(HOLE))


def test_each_note_is_triggered_by_a_test() -> None:
    assert len(register()) > 80, "the scan finds no notes"
    unheard = (note for note in register() if not any(tells(text, note) for text in expected()))
    missing = [f"{register()[note]}: {note}" for note in unheard]
    assert not missing, "notes without a test that quotes them:\n" + "\n".join(missing)


def test_each_note_of_a_run_has_one_kind_and_each_kind_occurs() -> None:
    """The table of kinds, which docs/howto/simulating.md shows, is that of what the sources say."""
    patterns = {
        name: re.compile(".*".join(re.escape(part.strip()) for part in kind.says.split("…")), re.DOTALL)
        for name, kind in NOTES.items()
    }
    kinds = {
        note: [name for name, pattern in patterns.items() if pattern.search(note)]
        for note, file in register().items()
        if file.startswith(tuple(f"symofros/{folder}/" for folder in ("simulation", "diagrams", "runtime", "blocks")))
    }
    unlike = [f"{register()[note]}: {note}: {names or 'no kind'}" for note, names in kinds.items() if len(names) != 1]
    assert not unlike, "notes of no kind, or of several:\n" + "\n".join(unlike)
    telling = {name for name, kind in NOTES.items() if max(map(len, kind.says.split("…"))) >= TELLING}
    assert {name for names in kinds.values() for name in names} == telling


MOMENTS = " ".join(
    f'{name}="{value}"' for name, value in zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), "111000", strict=True)
)
LINK = f'<link name="{{}}"><inertial><mass value="1"/><inertia {MOMENTS}/></inertial></link>'
JOINT = '<joint name="q{}" type="{}"><parent link="{}"/><child link="{}"/>{}</joint>'
SOUND = "".join(LINK.format(name) for name in "ab") + '<link name="base"/>'
AXIS, LONG_AXIS = '<axis xyz="0 0 1"/>', '<axis xyz="0 0 2"/>'
LIMIT, DAMPED = '<limit lower="-1" upper="1" effort="1" velocity="1"/>', '<dynamics damping="0.1" friction="0"/>'
CHAIN = JOINT.format(1, "{0}", "base", "a", "{1}") + JOINT.format(2, "continuous", "a", "b", AXIS)
# A link with mass is the base; a transmission with a joint beside the driven one.
BASED = JOINT.format(1, "continuous", "a", "b", AXIS) + JOINT.format(2, "fixed", "b", "base", "")
DRIVEN = '<transmission name="t"><gap_joint name="q1"/></transmission>'


ARM = sf.System(
    "arm", (sf.RigidBody("a", sf.Joint("q", "revolute", actuated=True), sf.Inertia(1.0, moments=(1, 1, 1))),)
)


def urdf(folder: Path, content: str) -> tuple[str, ...]:
    """The notes on a URDF file."""
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="r">{SOUND}{content}</robot>', encoding="utf-8")
    return sf.load(path).notes


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (CHAIN.format("continuous", AXIS + DAMPED), "damping of joints ignored"),
        (CHAIN.format("continuous", LONG_AXIS), "axes that are not unit vectors are normalised"),
        (CHAIN.format("planar", AXIS + LIMIT), "limits of planar joints ignored"),
        (CHAIN.format("continuous", AXIS) + '<gazebo><link name="c"/></gazebo>', "<link> in <gazebo> ignored"),
        (BASED, "inertia of the base dropped, it never moves"),
        (CHAIN.format("continuous", AXIS) + DRIVEN, "> of <transmission> ignored"),
        (CHAIN.format("continuous", AXIS), ""),
        (CHAIN.format("revolute", AXIS + LIMIT), ""),
        (CHAIN.format("planar", AXIS), ""),
    ],
)
def test_a_file_is_remarked_upon_where_something_of_it_is_left_out(tmp_path: Path, content: str, said: str) -> None:
    notes = urdf(tmp_path, content)
    # What is fixed to the world has no mass, and is said to.
    usual = (
        "links without <inertial> are massless: 1 link (base)",
        "<transmission> ignored: efforts are those of joints",
    )
    reported = [note for note in notes if not note.startswith(usual)]
    assert [said in note for note in reported] == [True] * bool(said), notes


@pytest.mark.parametrize("name", ["pendulum", "double_pendulum", "four_bar", "flexible_pendulum", "car", "heavy_top"])
def test_native_files_get_no_note(name: str) -> None:
    assert not MODELS[name].notes


@pytest.mark.parametrize("target", ["urdf", "mjcf", "c"])
def test_complete_exports_get_no_note(tmp_path: Path, target: str) -> None:
    assert not sf.export(ARM, target, tmp_path).notes


def test_late_steps_are_reported() -> None:
    """A function of inputs that sleeps for longer than a step of real time lasts; without a clock nothing is late."""

    def slow(t: float, q: object, v: object) -> list[float]:
        time.sleep(2e-3)
        return [0.0]

    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True)
    cart = sf.compile(sf.System("cart", (sf.RigidBody("b", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0)))
    for realtime in (True, False):
        run = sf.simulate(cart, t_end=0.01, u=slow, method="euler", dt=1e-3, realtime=realtime)
        assert bool([note for note in run.outcome.notes if "steps began late" in note]) == realtime
