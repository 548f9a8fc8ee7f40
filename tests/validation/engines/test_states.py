"""An engine that is right at one state of a new model and wrong elsewhere is seen, and its script is a proof."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.validation.engines.toys import FAULTS, Engine
from validation.engines import workers
from validation.engines.interface import SINGLE, Joint, Link, Registry, Slot, State, Statement, Tree, Unsupported, rows
from validation.engines.matrix import SEED, Judged, Truths, judged
from validation.engines.plugins import OWN
from validation.engines.plugins.writing.source import Source, SourcePlugin, Way
from validation.engines.proving import scripts
from validation.engines.scales import size_of
from validation.engines.truth.dynamics import neutral
from validation.engines.verdicts import expected, judge, refusals
from validation.engines.workers import Job

INERTIA = ((0.2, 0.01, 0.0), (0.01, 0.3, 0.0), (0.0, 0.0, 0.4))
ROOT = str(Path(__file__).parents[3])
TREE = Tree("pendulum", (Link("arm", -1, (Joint("revolute", axis=(0.6, 0.0, 0.8)),), 2.0, (0.5, 0.1, 0.2), INERTIA),))


def toy(fault: str, **more: Any) -> SourcePlugin:
    """A plug-in of text for the toy."""

    def write(tree: Tree) -> Source:
        (link,) = tree.links
        given = link.joints[0].axis, link.mass, link.com, link.inertia, tree.gravity, fault
        lines = (
            "import numpy as np",
            f"import sys; sys.path.append({ROOT!r})",
            "from tests.validation.engines.toys import Engine",
        )
        return Source((*lines, f"m = Engine{given!r}"), ((Slot("angle", (0,), (0,)),),), 1, 1)

    ways = {"bias": Way("weight", "value = m.weight(q[0], v[0])")}
    return SourcePlugin("toy", "numpy", "toy", (), {}, ways, write, find=lambda: "1.0", **more)


def asked(plugin: SourcePlugin, monkeypatch: pytest.MonkeyPatch, tree: Tree = TREE) -> Judged:
    Engine.calls = 0
    monkeypatch.setattr(workers, "registry", lambda: Registry({**OWN, plugin.name: plugin}))
    (one,) = judged(plugin, Job(plugin.name, tree, ("bias",), SEED, further=True), Truths())
    return one


@pytest.mark.parametrize(
    ("fault", "verdict", "words"),
    [
        ("", "right", ""),
        ("stale", "wrong", "at zero, after another state on the same model: right by itself"),
        ("at zero", "wrong", "at zero"),
        ("fast", "wrong", "at speeds times 100"),
        ("now and then", "wrong", "not finite: among, in one of many calls: not again"),
        ("forgets", "wrong", "another answer at the same state: at the first again, in one of many calls: not again"),
        ("breaks", "raises", "IndexError: list index out of range (toys.py:"),
        ("internal", "raises", "ValueError: shapes (6, 1) and (12, 1) don't match (toys.py:"),
        ("refuses", "refuses", "ValueError: hinges with a mass are not supported"),
        ("refuses shapes", "refuses", "ValueError: a link with collision shapes is not supported"),
    ],
)
def test_a_planted_fault_of_a_state_is_seen_and_its_state_is_named(
    fault: str, verdict: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell = asked(toy(fault, calls=60), monkeypatch).cell
    assert cell.verdict == verdict and cell.words.startswith(words), cell
    assert bool(words) or cell.words == ""


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("", "refuses 0 of 1 cells in its own words, within"),
        ("refuses", "refuses 1 of 1 cells in its own words, above"),
    ],
)
def test_how_much_an_engine_refuses_is_bounded(fault: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert refusals([asked(toy(fault), monkeypatch).cell]).startswith(said)


def test_every_planted_fault_is_asked_about() -> None:
    marks = test_a_planted_fault_of_a_state_is_seen_and_its_state_is_named.pytestmark  # type: ignore[attr-defined]
    assert {row[0] for row in marks[0].args[1]} == set(FAULTS)


@pytest.mark.parametrize("fault", ["stale", "at zero", "fast", "breaks"])
def test_the_script_of_a_state_is_a_proof(fault: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    plugin = toy(fault)
    red = asked(plugin, monkeypatch)
    path = tmp_path / "script.py"
    path.write_text(scripts.text(plugin, red, "none found"))
    output, failed = scripts.fails(path, "IndexError" if fault == "breaks" else "")
    assert failed, output


@pytest.mark.parametrize(
    ("statement", "fault", "verdict"),
    [
        (Statement("precondition", "not at zero", "manual, 3.1"), "at zero", "precondition"),
        (Statement("precondition", "not at zero", "manual, 3.1"), "", "right"),
        (Statement("precondition", "not so", "manual", functions="gravity"), "at zero", "wrong"),
        (Statement("repairs", "makes heavier", "manual", holds=lambda tree, text: bool(text)), "at zero", "wrong"),
        (Statement("repairs", "makes heavier", "manual", warned="heavier"), "at zero", "wrong"),
    ],
)
def test_documented_limits_explain_a_red_answer_and_hide_no_right_one(
    statement: Statement, fault: str, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell = asked(toy(fault, statements=(statement,)), monkeypatch).cell
    assert cell.verdict == verdict
    assert verdict != "precondition" or cell.words.startswith("not at zero (manual, 3.1): wrong by")


def test_the_roundings_of_single_precision_are_right_for_an_engine_of_single_precision() -> None:
    from validation.engines.truth.dynamics import random_state

    model = OWN["pinocchio"].build(TREE)
    state = random_state(TREE, model, SEED)  # type: ignore[arg-type]
    for roundoff, off, verdict in ((SINGLE, 1e-6, "right"), (SINGLE, 1e-1, "wrong"), (2.0**-52, 1e-6, "imprecise")):
        want = expected("bias", TREE, model, state, roundoff=roundoff)  # type: ignore[arg-type]
        assert judge("toy", TREE, "bias", want.value * (1.0 + 0.999 * off), want).verdict == verdict


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_no_answer_is_judged_beside_numbers_that_its_tree_makes_nothing_of(scale: float) -> None:
    """A pendulum that hangs down: its weight has a moment of roundings, whatever its size."""
    link = Link(
        "arm", -1, (Joint("revolute", axis=(0.0, 1.0, 0.0)),), scale**3, (0.0, 0.0, -scale), rows(scale**5 * np.eye(3))
    )
    tree = Tree("hanging", (link,))
    model = OWN["pinocchio"].build(tree)
    state = State(*(np.full(1, 1e-17) for _ in range(6)))
    want = expected("bias", tree, model, state)  # type: ignore[arg-type]
    assert 0.0 < np.abs(want.value).max() < want.allowed < 1e-9 * size_of("bias", tree)
    assert judge("toy", tree, "bias", want.value + 1e-16 * scale**4, want).verdict == "right"
    assert judge("toy", tree, "bias", want.value + 1e-5 * scale**4 * 9.81, want).verdict == "wrong"


def test_neutral_coordinates_move_nothing() -> None:
    """The truth places links at neutral coordinates where their joints are."""
    from validation.engines.models.kinds import tree_of
    from validation.engines.truth.arithmetic import exact, many_digits
    from validation.engines.truth.dynamics import Truth, digits

    for kind in ("ball", "free", "revolute unbounded", "planar", "universal"):
        for engine in ("pinocchio", "mujoco", "drake", "dart"):
            tree, plugin = tree_of(kind), OWN[engine]
            model = plugin.build(tree)
            if isinstance(model, Unsupported):
                continue
            with many_digits():
                (R, p), *_ = Truth(tree, model).kinematics.poses(exact(neutral(model)))
            placed = tree.links[0].joints[0]
            np.testing.assert_allclose(digits(R), np.array(placed.R), atol=1e-15)
            np.testing.assert_allclose(digits(p), np.array(placed.p), atol=1e-15)
