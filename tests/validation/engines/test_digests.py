"""What a cell is an answer to: whatever changes the answer or its verdict is another digest, all else is the same."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from decimal import Decimal
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from validation.engines import digests, verdicts
from validation.engines.functions import FUNCTIONS
from validation.engines.interface import Steps, Unsupported
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN
from validation.engines.plugins.writing.source import SourcePlugin, Way
from validation.engines.truth import charts, derived, dynamics, kinematics
from validation.engines.workers import Job

TREE = tree_of("ball")
JOB = Job("mujoco", TREE, ("mass_matrix", "gravity"), 20, further=True)


@pytest.fixture(autouse=True)
def _forgotten() -> None:
    forget()


def forget() -> None:
    """Forget digests that are known already."""
    for known in (digests._tree, digests._judging, digests._truth):
        known.cache_clear()
    digests._PLUGINS.clear()


def asked(job: Job = JOB, version: str = "1") -> str:
    return digests.asked(OWN["mujoco"], job, version)


@pytest.mark.parametrize(
    "changed",
    [
        {"seed": 21},
        {"further": False},
        {"form": "urdf"},
        {"text": "<robot/>"},
        {"functions": ("mass_matrix",)},
        {"functions": ("gravity", "mass_matrix")},
        {"tree": replace(TREE, gravity=(0.0, 0.0, -9.82))},
        {"tree": replace(TREE, links=(replace(TREE.links[0], compensation=1.0), *TREE.links[1:]))},
        {"tree": replace(TREE, changed="mass")},
    ],
)
def test_another_question_has_another_digest(changed: dict[str, Any]) -> None:
    assert asked(replace(JOB, **changed)) != asked() == asked(replace(JOB))


def test_another_engine_or_release_has_another_digest() -> None:
    assert asked(version="2") != asked() != digests.asked(OWN["mjx"], JOB, "1")


def test_code_that_has_a_part_in_the_answer_changes_it_and_other_code_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    before = asked()
    gravity = asked(replace(JOB, functions=("gravity",)))
    with monkeypatch.context() as changed:  # The truth of one function.
        changed.setitem(FUNCTIONS, "mass_matrix", replace(FUNCTIONS["mass_matrix"], truth=lambda t, s: -t.M(s.q)))
        forget()
        assert asked() != before and asked(replace(JOB, functions=("gravity",))) == gravity
    for helper in ((dynamics.Truth, "_mass_matrix"), (kinematics.Kinematics, "_walk"), (charts, "rotation")):
        with monkeypatch.context() as changed:  # What truths have a part of, a step and more away.
            changed.setattr(*helper, lambda *_: None)
            forget()
            assert asked() != before, helper
    with monkeypatch.context() as changed:  # What judges.
        changed.setattr(verdicts, "GROSS", 1e-5)
        forget()
        assert asked() != before
    with monkeypatch.context() as changed:  # What these cells have nothing of.
        changed.setattr(derived, "subtree_momenta", None)
        changed.setattr(dynamics.Truth, "subtree_momenta", lambda self: None, raising=False)
        changed.setitem(FUNCTIONS, "new", FUNCTIONS["gravity"])
        changed.setitem(OWN, "new", OWN["mjx"])
        forget()
        assert asked() == before


def test_the_text_that_an_engine_runs_counts_and_how_it_comes_about_does_not() -> None:
    plugin, before = OWN["mujoco"], asked()
    assert isinstance(plugin, SourcePlugin)

    def way(name: str, code: str) -> str:
        return digests.asked(replace(plugin, ways={**plugin.ways, name: Way("native", code)}), JOB, "1")

    def written(change: Any) -> str:
        return digests.asked(replace(plugin, write=lambda tree: change(plugin.write(tree))), JOB, "1")

    assert way("mass_matrix", "value = 0") != before == way("bias", "value = 0")
    assert written(lambda source: source) == before
    assert written(lambda source: replace(source, lines=("", *source.lines))) != before
    assert written(lambda source: replace(source, lacks=("mass_matrix",))) != before
    assert written(lambda source: Unsupported("no")) != written(lambda source: Unsupported("never")) != before
    for changed in ({"refusals": ("x",)}, {"calls": 3}, {"roundoff": 1.0}, {"gravity": (0.0, 0.0, 1.0)}):
        assert digests.asked(replace(plugin, **changed), JOB, "1") != before, changed
    assert digests.asked(replace(plugin, conventions=(), find=lambda: "2"), JOB, "1") == before


def test_of_steps_the_truth_of_what_differences_are_taken_of_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    plugin = OWN["mujoco"]
    assert isinstance(plugin, SourcePlugin)
    steps = plugin.ways["mass_matrix"]._replace(slack=Steps("potential_energy", 1e-6, 1e-6))
    other = replace(plugin, ways={**plugin.ways, "mass_matrix": steps})
    before = asked(), digests.asked(other, JOB, "1")
    monkeypatch.setitem(FUNCTIONS, "potential_energy", replace(FUNCTIONS["potential_energy"], truth=lambda t, s: None))
    forget()
    assert asked() == before[0] and digests.asked(other, JOB, "1") != before[1]


def every() -> str:
    """A digest of what all functions and plug-ins reach."""
    job = replace(JOB, functions=tuple(FUNCTIONS))
    return digests.digest(*(digests.asked(plugin, job, "1") for plugin in OWN.values()))


def test_digests_of_another_process_are_the_same() -> None:
    code = "from tests.validation.engines import test_digests as own; print(own.every())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == every()


def _scaled(factor: float) -> Any:
    return lambda x: factor * x


def _one(x: float) -> float:
    """Documented."""
    return x + 1.0


def _same(x: float) -> float:
    """Documented in other words."""
    # A comment.
    return x + 1.0


def test_digests_follow_the_contents_of_objects_but_not_their_docstrings() -> None:
    def reached(*roots: Any) -> str:
        return digests.reached(*roots, packages=["tests"])

    _same.__qualname__ = "_one"
    assert reached(_one) == reached(_same)
    pairs = [
        (_scaled(2.0), _scaled(3.0)),
        (partial(_one, 1.0), partial(_one, 2.0)),
        (np.array([1.0]), np.array([2.0])),
        (np.array([Decimal(1)]), np.array([Decimal(2)])),
        ({"a": _scaled(2.0)}, {"a": _scaled(3.0)}),
        ((1, "a"), (1, "b")),
        (re.compile("a"), re.compile("b")),
        (Holder(1.0), Holder(2.0)),
        (Holder(1.0).read, Holder(2.0).read),
        (frozenset("ab"), frozenset("ac")),
    ]
    for one, other in pairs:
        assert reached(one) == reached(one) != reached(other), one
    assert reached(SimpleNamespace(a=1)) == reached(SimpleNamespace(a=2))  # Of another package.


class _Both:
    def first(self) -> int:
        return self.second()

    def second(self) -> int:
        return 2

    def third(self) -> int:
        return 3


def _by_name() -> Any:
    return _Both().first()


def _by_text() -> Any:
    return [getattr(_Both(), name)() for name in ("third", "none")]


def test_of_a_class_the_methods_that_are_named_count(monkeypatch: pytest.MonkeyPatch) -> None:
    def reached(root: Any, **options: Any) -> str:
        return digests.reached(root, packages=["tests"], **options)

    roots = (_by_name, _by_text)
    before, whole = [reached(root) for root in roots], reached(_Both(), whole=True)
    for name, same in (("first", (False, True)), ("second", (False, True)), ("third", (True, False))):
        with monkeypatch.context() as changed:
            changed.setattr(_Both, name, lambda self: 0)
            assert tuple(reached(root) == was for root, was in zip(roots, before, strict=True)) == same, name
            assert reached(_Both(), whole=True) != whole


class Holder:
    """Holds a number."""

    def __init__(self, value: float) -> None:
        self.value = value

    def read(self) -> float:
        return self.value
