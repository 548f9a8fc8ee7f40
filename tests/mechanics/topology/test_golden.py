"""How mechanisms are numbered, and which limbs are equal, as text; cases are in the files of these names."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from symofros.mechanics.topology.limbs import equal_limbs
from symofros.mechanics.topology.tree import BASE, SpanningTree, build_tree
from tests.mechanics.trees_of_text import system_of_bodies
from tests.program_text import Case, assert_golden, golden_cases


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
