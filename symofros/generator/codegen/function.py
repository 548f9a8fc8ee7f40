"""One function of a program -> C text, in chunks of bounded length that pass values through `work`.

Compilers are superlinear in the length of a function; a chunk is compiled by itself, at the same speed of the result.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate, groupby
from typing import Literal

from symofros.base.routes import Choice, choose
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Output, Program
from symofros.generator.codegen.effort import pack_figures
from symofros.generator.codegen.limbs.plan import LimbPlan
from symofros.generator.codegen.loops import Item, Loop, loop_lines, with_loops
from symofros.generator.codegen.packs import PackPlan, Store
from symofros.generator.codegen.statements import Statement, StatementWriter
from symofros.generator.codegen.trigonometry import block_lines
from symofros.runtime.calls.kernel import LaneOptions, Precision

# Which packs a text has: those of functions that are faster with them by count, or all, as
# functions have that a routine finishes; where there are any, equal limbs share vectors, too.
Packs = Literal["none", "where they pay", "all"]
MAX_STATEMENTS = 1000
# Past this length, shorter chunks compile twice as fast and run as fast (measured on a 52-link chain, gcc 12); below
# it, long chunks run faster, because fewer values pass through memory.
_LONG, _LONG_CHUNK = 6000, 300
_ARRAY = re.compile(r"\b(\w+)\[|SYM_(?:AT|PUT)\((\w+),")
# Up to so many angles the sines of one vector of states leave the processor idle (2 to 13 joints are 5 to 45 % faster
# with a chunk of sines, 22 joints 2 % slower; gcc 12, AVX-512).
_FEW_ANGLES = 16
# Clear an output at once when at least this share of its entries is zero.
_SPARSE = 0.25


@dataclass(frozen=True)
class FunctionText:
    """C text of one function.

    Attributes:
        code: Definitions of its chunks and of the function that calls them.
        work: Scratch: doubles, or vectors of a function on vectors.
        choices: How it is written.
    """

    code: str
    work: int
    choices: tuple[Choice, ...] = ()


@dataclass(frozen=True)
class _Chunks:
    """Statements and loops in chunks.

    Attributes:
        chunks: Statements and loops of each chunk.
        slots: Index in `work` of each variable that crosses from one chunk into another, or the border of a loop.
        work: Doubles of scratch that the slots take.
    """

    chunks: list[list[Item]]
    slots: dict[int, int]
    work: int

    @staticmethod
    def of(chunks: list[list[Item]]) -> _Chunks:
        """The chunks, with slots for the variables that cross from one chunk into another or the border of a loop."""
        statements = (item for chunk in chunks for item in chunk if isinstance(item, Statement))
        widths = {s.vector.key: s.vector.width for s in statements if s.vector is not None}
        slots = _allocate(chunks, widths)
        return _Chunks(chunks, slots, max((slot + widths.get(key, 1) for key, slot in slots.items()), default=0))


class FunctionWriter:
    """Writes one function.

    Args:
        program: Staged program.
        c_name: Name of the C function.
        inputs: Names of the input arrays, in order.
        outputs: Outputs to be stored, in order.
        given: Whether parameter-only values are read from `pre` (false for the init function itself).
        packs: Which values formed by the same operations share vectors.
        limbs: Whether values of equal limbs do.
        by_routine: Whether a routine finishes what the function computes.

    Attributes:
        has_packs: Whether it forms vectors of packs.
        choices: How values share vectors, and how equal parts are written.
    """

    def __init__(
        self,
        program: Program,
        c_name: str,
        inputs: Sequence[str],
        outputs: Sequence[Output],
        given: bool = True,
        packs: Packs = "none",
        limbs: bool = False,
        by_routine: bool = False,
    ) -> None:
        self.c_name = c_name
        self.inputs = tuple(inputs)
        self.outputs = tuple(outputs)
        edges = [edge for output in outputs for edge in output.edges]
        pre = program.pre if given else {}
        stores = [Store(o.name, i, edge) for o in outputs for i, edge in enumerate(o.edges) if edge != 0]
        graph, nodes = program.graph, needed_nodes(program.graph, edges, pre)
        plan = PackPlan(graph, nodes, pre, edges) if packs != "none" and graph.packs else None
        figures = pack_figures(plan, len(nodes), stores) | {"by_routine": by_routine}
        self.has_packs = plan is not None and bool(plan.vectors)
        asked = {"none": "scalars", "where they pay": "", "all": "packs" if self.has_packs else ""}[packs]
        vectors = choose("values by vectors", figures, asked)
        nodes, plans = (nodes, []) if plan is None else (plan.nodes, [plan])
        self.writer = StatementWriter(graph, nodes, pre, stores, plans)
        self.statements = self.writer.statements()
        looped, spared = with_loops(self.writer, self.statements)
        of_limbs = cache(lambda: LimbPlan(graph, nodes, pre, edges, program.limbs, plan))
        # Loops leave less to be compiled than vectors, which stay out of them.
        parts = choose(
            "equal parts",
            {
                "statements": sum(max(1, len(statement.nodes)) for statement in self.statements),
                "repeated_statements": spared,
                "limb_groups": len(program.limbs) if limbs else 0,
                "operations": len(nodes),
                "spared_by_limbs": lambda: of_limbs().spared,
            },
        )
        if parts.method == "limbs":
            self.writer = StatementWriter(graph, nodes, pre, stores, [*plans, of_limbs()])
            self.statements = self.writer.statements()
        self._items = looped if parts.method == "loops" else list(self.statements)
        self.choices: tuple[Choice, Choice] = vectors, parts

    def text(self) -> FunctionText:
        """The C text for one state: chunk functions, then the function that unpacks pointers and calls them."""
        chunked = _Chunks.of(_chunks(self._items) or [[]])
        parts = [self._chunk(i, chunked) for i in range(len(chunked.chunks))]
        body = [f"    const double *restrict {name} = in[{i}];" for i, name in enumerate(self.inputs)]
        body += [f"    double *restrict {output.name} = out[{i}];" for i, output in enumerate(self.outputs)]
        body += [line for output in self.outputs for line in self._clear(output)]
        arguments = ", ".join([*self.inputs, *(output.name for output in self.outputs), "work"])
        body += [f"    {self.c_name}_{i}({arguments});" for i in range(len(parts))]
        head = f"static void {self.c_name}(const double *const *in, double *const *out, double *restrict work) {{"
        return FunctionText("\n".join([*parts, head, *body, "}"]), chunked.work, self.choices)

    def text_on_vectors(self, lanes: LaneOptions) -> FunctionText:
        """The C text for several states, one in each lane of a vector; of a writer without packs.

        Chunk by chunk, each for all vectors of states; entries that are always zero are left out, unless lanes are
        rows. The chunks stay apart from the loops around them, out of which compilers would carry their constants.
        """
        chunked = _Chunks.of(_chunks_in_lanes(self.statements) or [[]])
        writer, last = self.writer.in_lanes(lanes.single), len(chunked.chunks) - 1
        zeros = self._zeros("sym_set(0.0)") if lanes.in_rows else []
        parts = [self._chunk_in_lanes(i, chunked, writer, zeros if i == last else ()) for i in range(last + 1)]
        columns = [f"in[{i}]" for i in range(1, len(self.inputs))] + [f"out[{i}]" for i in range(len(self.outputs))]
        arguments = ["(const sym_p *)(in[0].at + i * in[0].next)"]
        arguments += [*(f"{x}.at + i * {x}.next, {x}.step" for x in columns), f"work + i * {chunked.work}"]
        calls = [
            f"    for (i = 0; i < count; ++i)\n        {self.c_name}_v_{k}({', '.join(arguments)});"
            for k in range(len(chunked.chunks))
        ]
        head = f"static void {self.c_name}_v(int count, const sym_column *in, const sym_column *out, sym_v *work) {{"
        return FunctionText("\n".join([*parts, head, "    int i;", *calls, "}"]), chunked.work)

    def text_on_device(self, precision: Precision) -> FunctionText:
        """The C text for the state of one thread: chunks as on vectors, of one lane, and the function that calls them.

        That function takes `pre`, then an address and a step of each array; of a writer without packs.
        """
        writer = self.writer.in_lanes(precision == "single")
        chunked = _Chunks.of(_chunks(self.statements) or [[]])
        parts = [self._chunk_in_lanes(i, chunked, writer) for i in range(len(chunked.chunks))]
        work = chunked.work
        pre, *inputs = self.inputs
        names = [*inputs, *(output.name for output in self.outputs)]
        arguments = [pre, *(f"{name}_at, {name}_step" for name in names), "work" if work else "NULL"]
        body = [f"    sym_v work[{work}];"] * (work > 0)
        body += self._zeros("0")
        calls = [f"    {self.c_name}_v_{k}({', '.join(arguments)});" for k in range(len(parts))]
        head = f"static inline void {self.c_name}_of_state({', '.join(self._strided_arguments())}) {{"
        return FunctionText("\n".join([*parts, head, *body, *calls, "}"]), work)

    def _strided_arguments(self) -> list[str]:
        """Declarations of the arguments of functions on vectors: `pre`, then an address and a step of each array."""
        pre, *inputs = self.inputs
        arguments = [f"const sym_p *restrict {pre}"]
        arguments += [f"const sym_number *restrict {name}_at, ptrdiff_t {name}_step" for name in inputs]
        return arguments + [f"sym_number *restrict {o.name}_at, ptrdiff_t {o.name}_step" for o in self.outputs]

    def _zeros(self, zero: str) -> list[str]:
        """Lines that fill the entries that are always zero, with their text of zero."""
        entries = ((output.name, i) for output in self.outputs for i, edge in enumerate(output.edges) if edge == 0)
        return [f"    SYM_PUT({name}, {i}, {zero});" for name, i in entries]

    def _clear(self, output: Output) -> list[str]:
        zeros = [i for i, edge in enumerate(output.edges) if edge == 0]
        if not zeros:
            return []
        if len(zeros) >= _SPARSE * len(output.edges) and len(zeros) > 4:
            return [f"    memset({output.name}, 0, {len(output.edges)} * sizeof *{output.name});"]
        return [f"    {output.name}[{i}] = 0.0;" for i in zeros]

    def _chunk(self, index: int, chunked: _Chunks) -> str:
        lines, used = self._body(index, chunked, self.writer, "double")
        names = [*self.inputs, *(output.name for output in self.outputs), "work"]
        lines = [f"    (void){name};" for name in names if name not in used] + lines
        arguments = [f"const double *restrict {name}" for name in self.inputs]
        arguments += [f"double *restrict {output.name}" for output in self.outputs] + ["double *restrict work"]
        # A single chunk may be inlined into its caller; several must stay apart.
        kind = "static SYM_NOINLINE" if len(chunked.chunks) > 1 else "static"
        return "\n".join([f"{kind} void {self.c_name}_{index}({', '.join(arguments)}) {{", *lines, "}"])

    def _chunk_in_lanes(self, index: int, chunked: _Chunks, writer: StatementWriter, more: Sequence[str] = ()) -> str:
        lines, used = self._body(index, chunked, writer, "sym_v", more)
        pre, *inputs = self.inputs
        unused = [
            f"    (void){name}_at, (void){name}_step;"
            for name in (*inputs, *(o.name for o in self.outputs))
            if name not in used
        ]
        unused += [f"    (void){name};" for name in (pre, "work") if name not in used]
        arguments = [*self._strided_arguments(), "sym_v *restrict work"]
        head = f"static SYM_NOINLINE void {self.c_name}_v_{index}({', '.join(arguments)}) {{"
        return "\n".join([head, *unused, *lines, "}"])

    def _body(
        self, index: int, chunked: _Chunks, writer: StatementWriter, real: str, more: Sequence[str] = ()
    ) -> tuple[list[str], set[str]]:
        """Lines of a chunk, and of `more` behind them, and the arrays that they mention."""
        items = chunked.chunks[index]
        looped = {key for item in items if isinstance(item, Loop) for keys in item.keys for key in keys}
        local = looped.union(key for item in items if isinstance(item, Statement) for key in item.keys)
        crossing = dict.fromkeys(key for item in items for key in item.reads if key not in local)
        lines = [self._load(key, chunked.slots[key], writer, real) for key in crossing]
        for item in items:
            # What a loop has computed is read back where it is first needed.
            lines += [self._load(key, chunked.slots[key], writer, real) for key in item.reads if key in looped]
            looped.difference_update(item.reads)
            if isinstance(item, Loop):
                lines += loop_lines(item, writer, chunked.slots, self._defining, self._storing)
            else:
                lines += self._lines(item, chunked.slots, writer, real)
        lines += more
        used = {a or b for line in lines for a, b in _ARRAY.findall(line)}
        return lines, used

    def _load(self, key: int, slot: int, writer: StatementWriter, real: str) -> str:
        if key < 0:
            return writer.vectors[key].load_line("work", slot)
        return f"    const {real} {writer.name(key)} = work[{slot}];"

    def _lines(self, statement: Statement, slots: Mapping[int, int], writer: StatementWriter, real: str) -> list[str]:
        lines = self._defining(statement, writer, real)
        for key in statement.keys:
            if key in slots and key < 0:
                lines.append(writer.vectors[key].store_line("work", slots[key]))
            elif key in slots:
                lines.append(f"    work[{slots[key]}] = {writer.name(key)};")
        return lines + self._storing(statement, writer)

    def _defining(self, statement: Statement, writer: StatementWriter, real: str = "double") -> list[str]:
        """The lines that define the variables of a statement."""
        if statement.angles:
            return block_lines(writer, statement)
        if statement.vector is not None:
            return statement.vector.lines(writer.text)
        return [f"    const {real} {writer.name(node)} = {writer.operation(node)};" for node in statement.nodes]

    def _storing(self, statement: Statement, writer: StatementWriter) -> list[str]:
        """The lines that fill entries of outputs."""
        lines: list[str] = []
        stores: Sequence[Store] = statement.stores
        if statement.vector is not None:
            lines, stores = statement.vector.stores_of_runs(stores)
        return lines + [f"    {writer.store(store)}" for store in stores]


def _chunks(items: Sequence[Item]) -> list[list[Item]]:
    """Statements and loops in chunks of much the same length of text; no chunk without statements."""
    ends = list(accumulate(map(len, items)))
    total = ends[-1] if ends else 0
    longest = MAX_STATEMENTS if total <= _LONG else _LONG_CHUNK
    size = -(-total // max(1, -(-total // longest)))
    by_chunk = groupby(zip(items, ends, strict=True), key=lambda item: (item[1] - len(item[0])) // size)
    return [[item for item, _ in group] for _, group in by_chunk]


def _chunks_in_lanes(statements: list[Statement]) -> list[list[Item]]:
    """Statements on vectors in chunks: a few sines and cosines that need no others come first, in a chunk of their own.

    They are one long wait, operation after operation; those of the next vector of states fill it.
    """
    made = {key: i for i, statement in enumerate(statements) for key in statement.keys}
    early: set[int] = set()
    late: set[int] = set()  # What needs sines.
    for i, statement in enumerate(statements):
        needs = {made[key] for key in statement.reads}
        if needs & late or any(statements[j].angles for j in needs):
            late.add(i)
        elif statement.angles:
            waiting = [i]
            while waiting:
                early.add(at := waiting.pop())
                waiting += {made[key] for key in statements[at].reads} - early
    if sum(len(statements[i].angles) for i in early) > _FEW_ANGLES:
        return _chunks(statements)
    first: list[Item] = [statement for i, statement in enumerate(statements) if i in early]
    return [first] * bool(first) + _chunks([statement for i, statement in enumerate(statements) if i not in early])


def _last_uses(chunks: list[list[Item]]) -> tuple[dict[int, int], set[int]]:
    """The last chunk that reads each value, and the values that other iterations of loops read."""
    last: dict[int, int] = {}
    fetched: set[int] = set()
    for i, chunk in enumerate(chunks):
        for item in chunk:
            if isinstance(item, Loop):
                fetched |= item.fetched
                last.update(dict.fromkeys(item.fetched, i))
            last.update(dict.fromkeys(item.reads, i))
    return last, fetched


def _allocate(chunks: list[list[Item]], widths: Mapping[int, int]) -> dict[int, int]:
    """Work slots for values that cross from one chunk into another, or are read by other iterations of loops.

    Slots of values are reused once these are dead, but for those of loops.

    Args:
        chunks: Statements and loops of each chunk.
        widths: Doubles of each vector, by its key.
    """
    last, fetched = _last_uses(chunks)
    slots: dict[int, int] = {}
    free: dict[int, list[int]] = defaultdict(list)
    ends: dict[int, list[int]] = {}
    count = 0
    for i, chunk in enumerate(chunks):
        # A slot is free in the chunk after its value's last use, since that chunk loads before it stores.
        for key in ends.pop(i - 1, []):
            free[widths.get(key, 1)].append(slots[key])
        for key in (key for item in chunk if isinstance(item, Statement) for key in item.keys):
            if last.get(key, i) > i or key in fetched:
                unused = free[widths.get(key, 1)]
                if not unused:
                    unused.append(count)
                    count += widths.get(key, 1)
                slots[key] = unused.pop()
                ends.setdefault(last[key], []).append(key)
    for loop in (item for chunk in chunks for item in chunk if isinstance(item, Loop)):
        # Side by side, so that loops find them by steps of one length.
        kept = [place for place, keys in enumerate(zip(*loop.keys, strict=True)) if not last.keys().isdisjoint(keys)]
        for keys in loop.keys:
            slots.update({keys[place]: count + n for n, place in enumerate(kept)})
            count += len(kept)
    return slots
