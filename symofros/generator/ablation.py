"""Each pass of the generator, and how to leave it out, to measure what it brings.

Results stay the same within rounding. Nothing in the generator uses this; passes are replaced while a context lasts,
in the whole process.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from typing import Any

import symofros.generator.passes as passes
from symofros.base.options import Options
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.ops import ADD, DIV, MUL
from symofros.expr.vector import Sym3, Vec3
from symofros.generator.codegen import function as functions
from symofros.generator.codegen.statements import StatementWriter
from symofros.generator.passes import stage
from symofros.generator.passes.chain import chain_sums
from symofros.mechanics.dynamics.bodies import inertia
from symofros.mechanics.spatial import rotations
from symofros.mechanics.spatial.rotations import MatrixRotation, RotationProduct
from symofros.runtime.build.toolchain import DEFAULT_FLAGS

Without = Callable[[], AbstractContextManager[object]]


@dataclass(frozen=True)
class Ablation:
    """A pass that can be left out.

    Attributes:
        name: Name of the pass in tables.
        what: Effect of the pass, in a sentence.
        without: Context in which programs are generated without the pass.
        options: Options changed so that programs are compiled without the pass.
    """

    name: str
    what: str
    without: Without = nullcontext
    options: Callable[[Options], Options] = lambda options: options


@contextmanager
def _replaced(owner: Any, name: str, value: object) -> Iterator[None]:
    before = getattr(owner, name)
    setattr(owner, name, value)
    try:
        yield
    finally:
        setattr(owner, name, before)


def _without_sharing() -> AbstractContextManager[None]:
    """Every sum, product and quotient is a node of its own."""
    known = Graph._node

    def fresh(self: Graph, key: object, op: str, args: tuple[Edge, ...]) -> int:
        return known(self, object() if op in (ADD, MUL, DIV) else key, op, args)

    return _replaced(Graph, "_node", fresh)


def _without_regrouping() -> AbstractContextManager[None]:
    """Inertia stays with its link, unless it is clamped to the parent."""
    return _replaced(inertia, "_split", inertia._if_clamped)


@contextmanager
def _without_turns() -> Iterator[None]:
    """Vectors and tensors are multiplied by whole rotation matrices."""

    def apply(self: RotationProduct, x_B: Vec3) -> Vec3:
        return self.matrix().times(x_B)

    def apply_inverse(self: RotationProduct, x_A: Vec3) -> Vec3:
        return self.matrix().T.times(x_A)

    def conjugate(self: RotationProduct, S_B: Sym3) -> Sym3:
        return MatrixRotation(self.matrix()).conjugate(self.g, S_B)

    with (
        _replaced(RotationProduct, "apply", apply),
        _replaced(RotationProduct, "apply_inverse", apply_inverse),
        _replaced(RotationProduct, "conjugate", conjugate),
    ):
        yield


def _without_staging() -> AbstractContextManager[None]:
    """What parameters determine is computed in every call."""
    return _replaced(
        stage, "_parameter_only", lambda graph: {n for n, slot in graph.slot.items() if slot.group == "par"}
    )


def _without_chains() -> AbstractContextManager[None]:
    """Sums are added up in the order in which they were formed."""
    return _replaced(passes, "PIPELINE", tuple(stated for stated in passes.PIPELINE if stated[0] is not chain_sums))


def _in_one_piece() -> AbstractContextManager[None]:
    return _replaced(functions, "MAX_STATEMENTS", 10**9)


ABLATIONS = (
    Ablation("sharing", "Equal operations are one node of the graph.", _without_sharing),
    Ablation(
        "regrouping",
        "What a joint cannot tell from its parent's inertia is booked there, before run time.",
        _without_regrouping,
    ),
    Ablation(
        "elementary turns",
        "Rotations act as products of turns about coordinate axes, by 4 multiplications each.",
        _without_turns,
    ),
    Ablation(
        "rounding noise",
        "Entries of constant rotations within 1e-15 of 0 and 1 are 0 and 1: cos(pi/2) is 6e-17.",
        lambda: _replaced(rotations, "EXACT", -1.0),
    ),
    Ablation(
        "constant factors",
        "c1 (c2 x) becomes (c1 c2) x.",
        lambda: _replaced(Graph, "_scale", lambda self, a, b: _both_numbers(self, a, b)),
    ),
    Ablation("staging", "What parameters alone determine is computed once for each set of them.", _without_staging),
    Ablation(
        "sums in chains",
        "x + a b + c d takes two fused multiply-adds, (a b + c d) + x three operations.",
        _without_chains,
    ),
    Ablation(
        "blocks of sines",
        "Sines and cosines of up to eight angles by polynomials in one vector; without: libm's.",
        lambda: _replaced(StatementWriter, "_blocks", lambda self: {}),
    ),
    Ablation(
        "packs", "Columns formed by the same operations share vectors.", options=lambda o: replace(o, packs=False)
    ),
    Ablation(
        "no search for vectors",
        "The compiler's own search for statements that could share vectors is off.",
        options=lambda o: replace(o, flags=tuple(f for f in DEFAULT_FLAGS if f != "-fno-tree-slp-vectorize")),
    ),
    Ablation("pieces", "Functions past 1000 statements are compiled in pieces.", _in_one_piece),
)


def _both_numbers(g: Graph, a: int, b: int) -> Edge | None:
    return g.constant(g.value[a] * g.value[b]) if a in g.value and b in g.value else None
