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

from validation.engines import digests
from validation.engines.functions import FUNCTIONS
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN
from validation.engines.plugins.writing.source import SourcePlugin
from validation.engines.truth import derived, dynamics
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
    with monkeypatch.context() as changed:  # What all truths have a part of.
        changed.setattr(dynamics.Truth, "M", lambda self, q: None)
        forget()
        assert asked() != before
    with monkeypatch.context() as changed:  # The plug-in's texts.
        plugin = OWN["mujoco"]
        assert isinstance(plugin, SourcePlugin)
        ways = {**plugin.ways, "bias": plugin.ways["bias"]._replace(code="value = 0")}
        assert digests.asked(replace(plugin, ways=ways), JOB, "1") != before
    with monkeypatch.context() as changed:  # What these cells have nothing of.
        changed.setattr(derived, "subtree_momenta", None)
        changed.setitem(FUNCTIONS, "new", FUNCTIONS["gravity"])
        changed.setitem(OWN, "new", OWN["mjx"])
        forget()
        assert asked() == before


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


def test_what_objects_hold_is_followed_and_what_documents_them_is_not() -> None:
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


class Holder:
    """Holds a number."""

    def __init__(self, value: float) -> None:
        self.value = value

    def read(self) -> float:
        return self.value
