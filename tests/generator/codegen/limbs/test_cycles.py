"""Groups of vertices that wait for each other."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from symofros.generator.codegen.limbs.cycles import strongly_connected


def test_a_chain_has_no_groups() -> None:
    """As long a chain as a function has operations."""
    assert not list(strongly_connected({i: {i - 1} for i in range(1, 50_000)}))


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=25))
def test_groups_are_strongly_connected_components(pairs: list[tuple[int, int]]) -> None:
    needs: dict[int, set[int]] = {}
    for a, b in pairs:
        needs.setdefault(a, set()).add(b)
    reached = {a: {a} for a in range(10)}
    for _ in range(10):
        for a, others in needs.items():
            reached[a] |= {c for b in others for c in reached[b]}
    groups = {frozenset(b for b in reached[a] if a in reached[b]) for a in range(10)}
    groups = {group for group in groups if len(group) > 1 or any(a in needs.get(a, ()) for a in group)}
    assert {frozenset(group) for group in strongly_connected(needs)} == groups
