"""All cells of the matrix, and proofs of the red ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from validation.engines.interface import EnginePlugin, Tree
from validation.engines.matrix import SEED, Judged, Truths, judged, suited
from validation.engines.scripts import Proof, prove
from validation.engines.workers import Job, Worker

RED = ("wrong", "imprecise", "crashes")


def gathered(
    plugins: Mapping[str, EnginePlugin], trees: Iterable[Tree], worker: Worker, after: Callable[[str], object]
) -> list[Judged]:
    """The cells of engines on trees.

    Args:
        plugins: Engines.
        trees: Trees.
        worker: Process that the engines run in.
        after: Told the name of each tree when it is done.
    """
    cells: list[Judged] = []
    for tree in trees:
        # Engines that keep a tree's joints alike share its truths; other trees have none in common with it.
        truths = Truths()
        for plugin in plugins.values():
            cells += judged(
                plugin, Job(plugin.name, suited(tree, plugin), tuple(plugin.functions), SEED), truths, worker
            )
        after(tree.name)
    return cells


def alike(cells: Sequence[Judged]) -> dict[tuple[str, str], list[Judged]]:
    """Red cells that are taken for one fault: one function of one engine, on trees where the same functions are red.

    Returns:
        Engine and function with the trees -> red cells, the first of which stands for the others.
    """
    signatures: dict[tuple[str, str], set[str]] = {}
    red = [one for one in cells if one.cell.verdict in RED]
    for one in red:
        signatures.setdefault((one.cell.engine, one.cell.model), set()).add(f"{one.cell.function} {one.cell.verdict}")
    groups: dict[tuple[str, str], list[Judged]] = {}
    for one in red:
        signature = " | ".join(sorted(signatures[one.cell.engine, one.cell.model]))
        groups.setdefault((f"{one.cell.engine} {one.cell.function}", signature), []).append(one)
    return groups


def proofs(
    plugins: Mapping[str, EnginePlugin],
    cells: Sequence[Judged],
    worker: Worker,
    folder: Path,
    after: Callable[[Proof], object],
) -> list[tuple[Proof, tuple[str, ...]]]:
    """A proven script for each fault, with the names of all trees that show it."""
    results = []
    for group in alike(cells).values():
        first = group[0]
        proof = prove(plugins[first.cell.engine], first, worker, Truths(), folder)
        results.append((proof, tuple(one.cell.model for one in group)))
        after(proof)
    return results
