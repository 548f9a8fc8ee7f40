"""A vector of equal limbs, and its C text."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from symofros.expr.edges import Edge
from symofros.expr.ops import ADD, DIV, MUL, STOP_GRADIENT
from symofros.generator.codegen.limbs.signs import Signs
from symofros.generator.codegen.packs import Store, vector_name

# Types of vectors by their lanes (native/model/limbs.c.in).
TYPES = {2: "sym_pair", 4: "sym_quad"}


@dataclass(eq=False)
class Operand:
    """What a vector is computed from: another vector, or an edge in each lane.

    Attributes:
        vector: The vector; None for edges.
        edges: Numbers, one a lane, or an edge that the limbs have in common; none beside a vector.
        signs: Sign by which each lane counts.
    """

    vector: LimbVector | None
    edges: tuple[Edge, ...]
    signs: Signs

    @property
    def is_common(self) -> bool:
        """Whether all lanes hold one edge."""
        return self.vector is None and len(set(self.edges)) == 1


@dataclass(eq=False)
class LimbVector:
    """A vector variable with a lane for each of some equal limbs, or a part of another one's text.

    Attributes:
        key: Negative number of the variable.
        first_node: Node of the first limb.
        width: Lanes of the variable, those beyond the last limb included.
        op: Operation; "" where scalars are put together.
        terms: Operands.
        nodes: (lane, whether the lane holds the negative) of each node that is read from the vector.
        is_inlined: Whether it stands where it is used.
    """

    key: int
    first_node: int
    width: int
    op: str
    terms: tuple[Operand, ...]
    nodes: dict[int, tuple[int, bool]] = field(default_factory=dict)
    is_inlined: bool = False

    @property
    def _mentioned(self) -> Iterator[Operand]:
        """The operands that its text mentions."""
        waiting = [*self.terms]
        while waiting:
            term = waiting.pop()
            if term.vector is not None and term.vector.is_inlined:
                waiting += term.vector.terms
            else:
                yield term

    @property
    def operands(self) -> list[LimbVector]:
        """Vectors that its text mentions."""
        return [term.vector for term in self._mentioned if term.vector is not None]

    @property
    def edges(self) -> list[Edge]:
        """Scalars that its text mentions."""
        return [edge for term in self._mentioned for edge in term.edges]

    @property
    def is_computed(self) -> bool:
        """Whether an operation gives it."""
        return bool(self.op)

    @property
    def size(self) -> int:
        """Operations of its text."""
        inlined = (term.vector.size for term in self.terms if term.vector is not None and term.vector.is_inlined)
        return (self.op in (ADD, MUL, DIV)) + sum(inlined)

    def lane_text(self, lane: int) -> str:
        """C expression of a lane."""
        return f"{vector_name(self.key)}[{lane}]"

    def lines(self, text: Callable[[Edge], str]) -> list[str]:
        """The line that defines it."""
        return [f"    const {TYPES[self.width]} {vector_name(self.key)} = {self._operation(text)};"]

    def load_line(self, array: str, index: int) -> str:
        """The line that reads it from an array."""
        kind = TYPES[self.width]
        return f"    const {kind} {vector_name(self.key)} = *(const {kind}_anywhere *)({array} + {index});"

    def store_line(self, array: str, index: int) -> str:
        """The line that leaves it in an array."""
        return f"    *({TYPES[self.width]}_anywhere *)({array} + {index}) = {vector_name(self.key)};"

    def stores_of_runs(self, stores: Sequence[Store]) -> tuple[list[str], Sequence[Store]]:
        """Lanes are stored one by one: entries of limbs lie apart."""
        return [], stores

    def _operation(self, text: Callable[[Edge], str]) -> str:
        if self.op == "":
            return self._literal([text(edge) for edge in self.terms[0].edges])
        first, *others = self.terms
        if not others:
            return self._operand(first, text)
        (second,) = others
        if self.op == ADD:
            sign = "-" if max(second.signs) < 0 else "+"
            return f"{self._operand(first, text)} {sign} {self._operand(second, text, is_right=True)}"
        sign = "*" if self.op == MUL else "/"
        left = self._operand(first, text, is_factor=True)
        return f"{left} {sign} {self._operand(second, text, is_factor=True, is_right=True)}"

    def _operand(
        self, term: Operand, text: Callable[[Edge], str], is_factor: bool = False, is_right: bool = False
    ) -> str:
        """An operand's text, in parentheses where C would otherwise group or associate differently.

        Args:
            term: The operand.
            text: Text of a scalar edge.
            is_factor: Whether it is a factor.
            is_right: Whether it follows the sign.
        """
        if term.vector is None and not term.is_common:
            return self._literal([text(edge) for edge in term.edges])
        mixed = self.op == ADD and len(set(term.signs)) > 1
        if term.vector is None:
            shown = text(term.edges[0])
        elif term.vector.is_inlined and term.vector.op:
            is_sum = term.vector.op in (ADD, STOP_GRADIENT)
            needs = is_sum and (is_factor or is_right) or (is_factor and is_right)
            shown = f"({term.vector._operation(text)})" if needs else term.vector._operation(text)
        else:
            shown = term.vector._operation(text) if term.vector.is_inlined else vector_name(term.vector.key)
        return f"{self._literal([repr(float(sign)) for sign in term.signs])} * {shown}" if mixed else shown

    def _literal(self, lanes: Sequence[str]) -> str:
        """Text "(sym_pair){0.1, 0.2}"; lanes beyond the last limb repeat the first, so that they are as harmless."""
        padded = [*lanes, *[lanes[0]] * (self.width - len(lanes))]
        return f"({TYPES[self.width]}){{{', '.join(padded)}}}"
