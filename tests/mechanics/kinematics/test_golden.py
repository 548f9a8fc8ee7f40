"""What joints and frames are on the graph, as text; cases are in the files of these names."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.program import Function, Output, Program
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import TreeKinematics, tree_kinematics
from symofros.mechanics.topology.tree import build_tree
from tests.mechanics.trees_of_text import system_of_bodies
from tests.program_text import Case, assert_golden, golden_cases, program_text

Named = dict[str, Iterable[Edge]]


def text_of(kinematics: TreeKinematics, groups: tuple[str, ...], outputs: Named) -> str:
    """The outputs as a function, one line each."""
    formed = tuple(Output(name, (len(edges),), edges) for name, of in outputs.items() for edges in [tuple(of)])
    return program_text(Program("text", kinematics.g, {}, (Function("kinematics", "", groups, formed),)))


def joint_text(lines: str, folder: Path) -> str:
    """A joint's motion: rotation, displacement, and of each speed the partial velocities and their rates."""
    kinematics = tree_kinematics(Graph(), build_tree(system_of_bodies(f"b: {{joint: {lines}}}", folder)))
    (link,) = kinematics.links
    outputs: Named = {"R_AL": link.R_AL.matrix().entries, "p_AL": link.p_AL}
    for k, partial in enumerate(link.partial_velocities):
        outputs |= {f"w_{k}": partial.w, f"v_{k}": partial.v}
        rates: Named = {f"w_{k}_rate": partial.w_rate, f"v_{k}_rate": partial.v_rate}
        outputs |= {name: edges for name, of in rates.items() if any(edges := tuple(of))}
    return text_of(kinematics, ("q", "v", "u"), outputs)


def frame_text(lines: str, folder: Path) -> str:
    """What the last frame of a mechanism has."""
    tree = build_tree(system_of_bodies(lines, folder))
    frames = FrameKinematics(tree_kinematics(Graph(), tree))
    frame, nv = tree.frames[-1], len(tree.coordinates.v)
    pose, v_rate = frames.pose(frame), [frames.g.input("a", k) for k in range(nv)]
    outputs: Named = {"p_WF": pose.p_WF, "R_WF": pose.R_WF.entries, "velocity": frames.velocity(frame)}
    outputs["acceleration"] = frames.acceleration(frame, v_rate)
    for name, rows in (("jacobian", frames.jacobian(frame)), ("jacobian_rate", frames.jacobian_rate(frame))):
        outputs |= {f"{name}_{k}": column for k, column in enumerate(zip(*rows, strict=True))}
    return text_of(frames.kinematics, ("q", "v", "a", "u"), outputs)


@pytest.mark.parametrize("case", golden_cases(__file__, "joints"))
def test_joints_move_as_stated(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert_golden(case, lambda text: joint_text(text, tmp_path), request)


@pytest.mark.parametrize("case", golden_cases(__file__, "frames"))
def test_frames_move_as_stated(case: Case, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    assert_golden(case, lambda text: frame_text(text, tmp_path), request)
