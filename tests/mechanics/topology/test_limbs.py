"""Which limbs of a tree are equal."""

from __future__ import annotations

import symofros as sf
from symofros.expr.graph import Slot
from symofros.mechanics.topology.limbs import equal_limbs
from symofros.mechanics.topology.tree import build_tree
from tests.mechanics.topology.test_tree import body


def joints(stated: sf.System) -> list[list[list[str]]]:
    """The groups of equal limbs by the names of their coordinates."""
    tree = build_tree(stated)
    groups = equal_limbs(tree)
    return [[[tree.coordinates.q[slot.index] for slot in limb if slot.group == "q"] for limb in g] for g in groups]


def test_arms_and_legs_are_groups_of_their_own() -> None:
    bodies = [body("trunk", "world", "free")]
    for side in ("l", "r"):
        bodies += [body(f"arm_{side}", "trunk"), body(f"hand_{side}", f"arm_{side}", "prismatic")]
        bodies += [body(f"hip_{side}", "trunk", "ball"), body(f"leg_{side}", f"hip_{side}")]
    groups = joints(sf.System("s", bodies))
    assert groups[0] == [["q_arm_l", "q_hand_l"], ["q_arm_r", "q_hand_r"]]
    assert [[limb[-1] for limb in group] for group in groups] == [["q_hand_l", "q_hand_r"], ["q_leg_l", "q_leg_r"]]


def test_entries_of_q_v_and_a_stand_in_one_order() -> None:
    tree = build_tree(sf.System("s", [body("a", "world", "ball"), body("b", "world", "ball")]))
    ((first, second),) = equal_limbs(tree)
    assert first == tuple(Slot(group, i) for group, size in (("q", 4), ("v", 3), ("a", 3)) for i in range(size))
    assert second == tuple(Slot(slot.group, slot.index + (4 if slot.group == "q" else 3)) for slot in first)


def test_deep_limbs_do_not_exhaust_the_stack() -> None:
    chains = [body(f"{side}{i}", f"{side}{i - 1}" if i else "world") for side in "lr" for i in range(1500)]
    assert [len(limb) for limb in joints(sf.System("deep", chains))[0]] == [1500, 1500]
