"""Edits of big models in the editor: from what is asked to the answer's text, as the server makes it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import symofros as sf
from reference_models import MODELS
from reference_models.rigid.chain import chain
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import Workspace
from validation.inputs.cases import ROBOTS, robot_file

Edit = Callable[[str, int], list[dict[str, Any]]]
KINDS: dict[str, Edit] = {
    "mass": lambda body, i: [
        {"op": "set", "path": ["bodies", body, "inertia", "mass"], "value": 1.0 + i / 8},
    ],
    "add a body": lambda body, i: [
        {"op": "set", "path": ["bodies", f"b{i}"], "value": {"joint": {"kind": "revolute", "name": f"j{i}"}}},
    ],
    "rename": lambda body, i: [
        {"op": "rename", "path": ["bodies", f"x{i - 1}" if i else body], "to": f"x{i}"},
    ],
}


def system(name: str) -> sf.System:
    if name == "talos":
        return sf.load(robot_file(ROBOTS["talos"].file), floating_base=True)
    return chain(int(name.removeprefix("chain"))) if name.startswith("chain") else MODELS[name]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "name", ["mss", *(pytest.param(name, marks=pytest.mark.slow) for name in ("chain52", "talos", "chain300"))]
)
def test_time_of_an_edit_in_a_large_document(benchmark: BenchmarkFixture, tmp_path: Path, name: str, kind: str) -> None:
    sf.save(system(name), tmp_path / "big.yaml")
    session = Session(Workspace(tmp_path), tmp_path / "big.yaml")
    bodies = list(session.as_json()["data"]["bodies"])
    body, done = bodies[len(bodies) // 2], 0

    def edit() -> str:
        nonlocal done
        body_ = {"revision": session.document.revision, "label": kind, "edits": KINDS[kind](body, done)}
        done += 1
        session.edit(body_)
        return json.dumps(session.as_json())

    assert '"can_undo": true' in benchmark(edit)
