"""Texts of models that engines read: angles of rotations."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from validation.engines.interface import State
from validation.engines.plugins.writing.source import Source, SourceModel, Way, ways_of
from validation.engines.plugins.writing.urdf import rpy
from validation.mechanics.geometry import rotation_matrix


@pytest.mark.parametrize("noise", [0.0, 1e-16, 1e-12, 1e-9, 1e-8, 1e-7])
def test_angles_near_right_angles_give_the_written_rotation(noise: float) -> None:
    rng = np.random.default_rng(1)
    for quarters in product(range(4), repeat=3):
        R = rotation_matrix("rpy", np.array(quarters) * np.pi / 2 + noise * rng.standard_normal(3))
        np.testing.assert_allclose(rotation_matrix("rpy", np.array(rpy(R.tolist()))), R, rtol=0, atol=1e-14)


def test_ways_that_build_the_same_share_it_and_what_closes_runs_for_each() -> None:
    built = (("made.append('tree')", "made.append('own')"), ("'closed'", "'closed own'"))
    ways = {name: Way(name, f"value = {k}.0", built=built * (k > 1)) for k, name in enumerate("pqrs")}
    source = Source(("made.append('tree')",), (), 0, 0, closing=("made.append('closed')",))
    made: list[str] = []
    model, nothing = SourceModel(source, ways, {"made": made}), State(*[np.zeros(0)] * 6)
    assert [float(np.asarray(model.call(name, nothing))) for name in "pqrs"] == [0.0, 1.0, 2.0, 3.0]
    assert made == ["tree", *["closed"] * 3, "own", *["closed own"] * 2]
    assert source.built(ways["s"]) == ("made.append('own')", "made.append('closed own')")


def test_functions_of_links_are_evaluated_for_those_that_are_wanted() -> None:
    """By the list that the text goes through, or chosen from what it gives of all; the next call has all again."""
    ways = {"cut": Way("cut", "seen.append(len(bs))\nvalue = [b + q for b in bs]")}
    ways["whole"] = Way("whole", "seen.append(0)\nvalue = [b + q for b in (3.0, 1.0, 4.0)]")
    seen: list[int] = []
    source = Source((), (), 1, 1, {"bs": ("bs = [3.0, 1.0, 4.0]",)}, of_links="bs")
    model = SourceModel(source, ways, {"seen": seen})
    states = [State(np.array([q]), *[np.zeros(1)] * 5) for q in (0.5, 0.25)]
    for name in ways:
        assert np.array_equal(model.each(name, states, (2, 0)), [[[4.5], [3.5]], [[4.25], [3.25]]])
        assert np.array_equal(model.each(name, states), [[[3.5], [1.5], [4.5]], [[3.25], [1.25], [4.25]]])
    assert seen == [2, 2, 3, 3, 0, 0, 0, 0]


def test_ways_are_read_from_their_text() -> None:
    start = "d.q = q\nd.v = v\n"
    ways = ways_of(f"""
== bias:again | h, of m | {start}value = m.h | d.h
== # An engine's own sum.
# It goes on.
== sum ~ {1e-9} | total
{start}for k in range(2):
    d.q += k

value = d.q
== mass | M | value = m.M
""")
    assert ways == {
        "bias:again": Way("h, of m", f"{start}value = m.h | d.h"),
        "sum": Way("total", f"{start}for k in range(2):\n    d.q += k\n\nvalue = d.q", 1e-9),
        "mass": Way("M", "value = m.M"),
    }
    for wrong, why in (
        ("== mass | M | value = 1\n== mass | N | value = 2", "two ways of one name: mass"),
        ("== mass", "not enough values"),
    ):
        with pytest.raises(ValueError, match=why):
            ways_of(wrong)
