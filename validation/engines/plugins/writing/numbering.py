"""How engines number joints that they take in the order of a tree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...interface import Slot, Tree, Unsupported
from ...truth.charts import CHARTS

Numbered = tuple[tuple[tuple[Slot, ...], ...], int, int]


def numbered(tree: Tree, charts: Mapping[tuple[str, str], str]) -> Numbered | Unsupported:
    """`in_series`, of trees that files state: of some of their joints an engine may have none."""
    for joint in (joint for link in tree.links for joint in link.joints):
        if joint.kind != "fixed" and (joint.kind, joint.form) not in charts:
            return Unsupported(f"no joint of kind {joint.kind} {joint.form}".strip(), offered=False)
    return in_series(tree, charts)


def in_series(tree: Tree, charts: Mapping[tuple[str, str], str]) -> Numbered:
    """Slots of an engine that numbers joints as the tree does, nq and nv.

    Args:
        tree: The tree.
        charts: Kind and form of a joint -> chart.
    """
    slots: dict[str, tuple[Slot, ...]] = {}
    nq = nv = 0
    for link in tree.links:
        own = []
        for joint in link.joints:
            if joint.kind == "fixed":
                continue
            chart = charts[joint.kind, joint.form]
            if joint.mimics:
                own.append(replace(slots[joint.mimics][0], chart=chart))
                continue
            size = CHARTS[chart]
            own.append(Slot(chart, tuple(range(nq, nq + size.nq)), tuple(range(nv, nv + size.nv))))
            nq, nv = nq + size.nq, nv + size.nv
        slots[link.name] = tuple(own)
    return tuple(slots.values()), nq, nv


def is_depth_first(tree: Tree) -> bool:
    """Whether each link follows the one that it hangs on, or the last of what another hangs there before it."""
    path = [-1]
    for k, link in enumerate(tree.links):
        if link.parent not in path:
            return False
        path = [*path[: path.index(link.parent) + 1], k]
    return True


def attached(tree: Tree) -> set[int]:
    """Links of the model that is attached to the others'."""
    own: set[int] = set()
    for k, link in enumerate(tree.links):
        if link.parent in own or (tree.attached and link.name == tree.attached):
            own.add(k)
    return own
