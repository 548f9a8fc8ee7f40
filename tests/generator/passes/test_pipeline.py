"""After each pass, its post-condition and the packs are verified."""

from __future__ import annotations

from dataclasses import replace

import pytest

from symofros.expr.edges import ONE
from symofros.expr.graph import Graph
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.expr.program import Function, Output, Program
from symofros.generator import passes


def packed() -> Program:
    g = Graph()
    x = Pack(tuple(g.input("q", i) for i in range(WIDTH)))
    _, pack = linear_combination(g, [(g.input("v", 0), (ONE, x))])
    outputs = (Output("y", (WIDTH,), pack.lanes),)
    return Program("p", g, {"q": WIDTH, "v": 1}, (Function("f", "", ("q", "v"), outputs),))


def with_another_sign(program: Program) -> Program:
    """A pass that negates a factor of a pack and leaves its lanes."""
    pack = program.graph.packs[0]
    ((factor, operand),) = pack.terms
    program.graph.packs[0] = replace(pack, terms=((-factor, operand),))
    return program


def test_packs_survive_all_passes() -> None:
    assert [len(pack.new_lanes) for pack in passes.run_passes(packed()).graph.packs] == [WIDTH]


def test_packs_are_verified_once_in_each_graph(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Graph] = []
    monkeypatch.setattr(passes, "check_packs", lambda program: seen.append(program.graph))
    program = passes.run_passes(packed())
    assert len(seen) == 2  # As it was formed, and in chains.
    assert seen[-1] is program.graph


@pytest.mark.parametrize("place", range(len(passes.PIPELINE) + 1))
def test_a_pass_that_breaks_a_pack_is_refused(place: int, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = list(passes.PIPELINE)
    broken.insert(place, (with_another_sign, lambda program: None))
    monkeypatch.setattr(passes, "PIPELINE", tuple(broken))
    with pytest.raises(AssertionError, match="pack 0: lane 0 is computed by other operations"):
        passes.run_passes(packed())
