"""How mechanisms are numbered, which limbs are equal, what is wrong, as text; cases are in the files of these names."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

import symofros as sf
from symofros.mechanics.topology.limbs import equal_limbs
from symofros.mechanics.topology.tree import BASE, SpanningTree, build_tree
from symofros.mechanics.topology.units import unit_problems
from tests.mechanics.trees_of_text import system_of_bodies
from tests.program_text import Case, assert_golden, golden_cases

SOLID = {"mass": 1, "moments": [1, 1, 1]}
# A sound arm of two links. Cases of problems.txt add entries to it, or replace its own; null takes one away.
ARM: dict[str, dict[str, Any]] = {
    "parameters": {"L1": 1.0},
    "bodies": {
        "arm1": {"joint": {"name": "q1", "kind": "revolute"}, "frames": {"tip": {"position": ["L1", 0, 0]}}},
        "arm2": {"joint": {"name": "q2", "kind": "revolute", "parent": "arm1", "frame": "tip"}},
    },
}


# Units are stated of all but c; cases of units.txt state what has one, too.
UNITS = {"J": "kg m^2", "m": "kg", "L": "m", "k": "N m/rad"}
PENDULUM: dict[str, dict[str, Any]] = {
    "parameters": {"c": 1.0} | {name: {"value": 1.0, "unit": unit} for name, unit in UNITS.items()},
    "inputs": {"u": {"unit": "N m"}},
}


def written(base: dict[str, dict[str, Any]], stated: str, folder: Path) -> Path:
    """A file of a system with a case's entries."""
    given = YAML(typ="safe").load(stated)
    whole = {section: base.get(section, {}) | given.get(section, {}) for section in base | given}
    whole = {section: {k: x for k, x in entries.items() if x is not None} for section, entries in whole.items()}
    for body in whole["bodies"].values():
        if "joint" in body and body.setdefault("inertia", SOLID) is None:
            del body["inertia"]
    (folder / "arm.yaml").write_text(json.dumps({"symofros": 1} | whole), encoding="utf-8")
    return folder / "arm.yaml"


def without_places(text: str) -> str:
    """Lines are those of the file, not of the case."""
    return re.sub(r"^\S*arm\.yaml(:\d+)?: ", "", text, flags=re.MULTILINE)


def problem_text(stated: str, folder: Path) -> str:
    """What compiling the arm with a case's entries complains about."""
    try:
        sf.compile(sf.load(written(ARM, stated, folder)), sf.Options(backend="interpreter"))
    except sf.DescriptionError as error:
        return without_places(str(error))
    return "sound"


def unit_text(stated: str, folder: Path) -> str:
    """What the units of a case's entries are at odds with."""
    problems = unit_problems(sf.load(written(PENDULUM, stated, folder)))
    return without_places("\n".join(map(str, problems))) or "sound"


def tree_lines(tree: SpanningTree) -> Iterator[str]:
    """A line a link, the frames of each link and the base, and the names of q, v and u."""
    for i, link in enumerate(tree.links):
        on = "base" if link.parent == BASE else tree.links[link.parent].name
        q, v = (f"{name}[{start}:{start + size}]" for name, (start, size) in (("q", link.q), ("v", link.v)))
        inertias = f"{len(link.inertias)} {'inertia' if len(link.inertias) == 1 else 'inertias'}"
        station = "" if link.station is None else f", station {link.station.xi} of link {link.station.tip}"
        yield f"{i} {link.name}: on {on} by {len(link.placement)} steps, {q}, {v}, {inertias}{station}"
    for i in range(BASE, len(tree.links)):
        frames = [f"{frame.name} ({len(frame.placement)})" for frame in tree.frames if frame.link == i]
        if frames:
            yield f"frames of {'base' if i == BASE else i}: {', '.join(frames)}"
    names = tree.coordinates
    for group, stated in (("q", names.q), ("v", names.v), ("u", names.u)):
        if stated:
            yield f"{group}: {', '.join(stated)}"


def limb_lines(tree: SpanningTree) -> Iterator[str]:
    """A line a group: the coordinates of each limb."""
    for group in equal_limbs(tree):
        limbs = [[tree.coordinates.q[slot.index] for slot in limb if slot.group == "q"] for limb in group]
        yield " = ".join(", ".join(limb) for limb in limbs)


@pytest.mark.parametrize("case", golden_cases(__file__, "trees"))
def test_links_frames_and_coordinates_are_numbered_as_stated(
    case: Case, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    assert_golden(case, lambda text: "\n".join(tree_lines(build_tree(system_of_bodies(text, tmp_path)))), request)


@pytest.mark.parametrize("case", golden_cases(__file__, "limbs"))
def test_limbs_are_grouped_as_stated(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert_golden(case, lambda text: "\n".join(limb_lines(build_tree(system_of_bodies(text, tmp_path)))), request)


@pytest.mark.parametrize("case", golden_cases(__file__, "problems"))
def test_faults_of_mechanisms_are_named_as_stated(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert_golden(case, lambda text: problem_text(text, tmp_path), request)


@pytest.mark.parametrize("case", golden_cases(__file__, "units"))
def test_units_that_do_not_fit_are_named_as_stated(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert_golden(case, lambda text: unit_text(text, tmp_path), request)
