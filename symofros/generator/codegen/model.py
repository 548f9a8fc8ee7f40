"""Program + ModelRecord -> one C file, by filling a template with finished strings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from string import Template
from textwrap import wrap
from typing import NamedTuple

from symofros.base.c_text import c_string, comment, strings
from symofros.base.names import identifier
from symofros.base.routes import Choice
from symofros.expr.edges import Edge
from symofros.expr.garbage import without_collection
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Function, Output, Program
from symofros.generator.codegen import lanes, trigonometry
from symofros.generator.codegen.function import FunctionText, FunctionWriter
from symofros.generator.codegen.function import Packs as Packs
from symofros.generator.codegen.limbs.vector import TYPES
from symofros.generator.codegen.solvers import routines, solves_system, sparse_systems, with_solver
from symofros.generator.codegen.sparse import SparseSystem
from symofros.generator.passes.count import count_program
from symofros.native import native_text
from symofros.runtime.calls.kernel import LaneOptions
from symofros.runtime.record import ModelRecord

_INIT = "init_par"
# Columns of a comment; stands for a space where a line of it may not break.
_WIDTH, _SPACE = 112, "\x00"
# Names of parameters that a value without a name is described by.
_MAX_NAMES = 4


class ModelText(NamedTuple):
    """The C file of a program.

    Attributes:
        code: Its text.
        choices: Methods by which each function is formed and written, where there are several, keyed by name and frame.
    """

    code: str
    choices: dict[tuple[str, str], tuple[Choice, ...]]


def model_source(
    program: Program,
    record: ModelRecord,
    generator: str,
    in_lanes: LaneOptions | None = None,
    c_name: str | None = None,
    packs: Packs = "none",
) -> str:
    """The C file of a program; arguments as of `model_text`."""
    return model_text(program, record, generator, in_lanes, c_name, packs).code


@without_collection()
def model_text(
    program: Program,
    record: ModelRecord,
    generator: str,
    in_lanes: LaneOptions | None = None,
    c_name: str | None = None,
    packs: Packs = "none",
) -> ModelText:
    """The C file of a program, and how its functions are written.

    Args:
        program: Staged program.
        record: Names and defaults of the model.
        generator: Name and version of the generator.
        in_lanes: Options of the code that takes several states of a batch at once; None for none.
            Functions with a solver have none: the solver takes the time, and it pivots (docs/theory/code.md).
        c_name: Prefix of symbols; made of the record's name by default.
        packs: Where values of one state formed by the same operations, or for equal limbs, share vectors, which takes
            GNU C; not in lanes, where every value is a vector already.
    """
    name = c_name or identifier(record.name)
    vectors = in_lanes if any(function.solver is None for function in program.functions) else None
    described = _described_pre(program, record)
    head = legend(record, "parameters -> pre, all that depends on them alone", ["par"], described=described)
    texts = ["\n".join([*head, _init_function(program, name)])]
    rows, (sparse, system) = [], sparse_systems(program)
    for i, function in enumerate(program.functions):
        c_function = f"{name}_{identifier(function.name)}_f{i}"
        chosen = (*function.choices, *([system] if system is not None and solves_system(function) else []))
        solved = sparse.get(function.name)
        text, row = _one_function(program, record, function, c_function, vectors, packs, solved, chosen)
        texts.append(text)
        rows.append(row)
    code = Template(native_text("model/model.c.in")).substitute(
        title=comment(record.name),
        generator=generator,
        hash=record.hash,
        operations=operations_text(program),
        functions="\n\n".join([*_called(texts, vectors, packs), *routines(program, bool(sparse)), *texts]),
        tables="\n".join(
            [*(row.tables for row in rows), _function_table(name, rows), *_lane_table(name, rows, vectors)]
        ),
        n_functions=len(rows),
        lanes="NULL" if vectors is None or vectors.in_rows else f"SYM_LANE_TABLE({name})",
        kind="sym_stateful_model" if record.state_names else "sym_model",
        open="{" if record.state_names else "",
        close=f"}}, {len(record.state_names)}" if record.state_names else "",
        member=".model" if record.state_names else "",
        c_name=name,
        name=c_string(record.name),
        nq=len(record.q_names),
        nv=len(record.v_names),
        nu=len(record.u_names),
        npar=len(record.par_names),
        nc=record.nc,
        npre=len(program.init),
        q_names=strings(record.q_names),
        v_names=strings(record.v_names),
        u_names=strings(record.u_names),
        par_names=strings(record.par_names),
        par_default=_numbers(record.par_default),
        q_neutral=_numbers(record.q_neutral),
    )
    return ModelText(code, {(f.name, f.frame): row.choices for f, row in zip(program.functions, rows, strict=True)})


def _called(texts: Sequence[str], vectors: LaneOptions | None, packs: Packs) -> Iterator[str]:
    """Definitions of the routines that the texts call: trigonometry, lanes, packs, and vectors of limbs."""
    yield from trigonometry.routines(texts, vectors is not None)
    if vectors is not None:
        yield lanes.routines(vectors)
    if any("sym_pack " in text or (packs != "none" and "sym_respond(" in text) for text in texts):
        yield native_text("model/pack.c.in")
    if any(f"{kind} " in text for kind in TYPES.values() for text in texts):
        yield native_text("model/limbs.c.in")


def operations_text(program: Program) -> str:
    """Lines of a comment: operations of each function, and of the parameters' part."""
    counts = count_program(program)
    titles = [" of ".join(filter(None, key)) for key in counts]
    width = max(map(len, titles), default=0) + 2
    rows = zip(titles, counts.values(), strict=True)
    return "\n".join(comment(f" *   {title:<{width}}{count}") for title, count in rows)


def _init_function(program: Program, name: str) -> str:
    """Parameters -> pre, behind the plain signature of the struct's `init`."""
    writer = FunctionWriter(
        program, f"{name}_init", ["par"], [Output("pre", (len(program.init),), program.init)], False
    )
    text = writer.text()
    lines = [
        f"static void {name}_{_INIT}(const double *par, double *pre) {{",
        f"    double work[{max(1, text.work)}];",
        "    const double *in[1];",
        "    double *out[1];",
        "    in[0] = par;",
        "    out[0] = pre;",
        f"    {name}_init(in, out, work);",
        "}",
    ]
    return "\n".join([text.code, *lines])


@dataclass(frozen=True)
class _Row:
    """A function in the tables of a C file.

    Attributes:
        tables: Text of the tables of its arrays.
        row: Row of the table of functions.
        lanes: Row of the table of functions on vectors.
        choices: How the function is written.
    """

    tables: str
    row: str
    lanes: str
    choices: tuple[Choice, ...]


def legend(
    record: ModelRecord,
    title: str,
    inputs: Iterable[str],
    returns: Sequence[tuple[str, tuple[int, ...]]] = (),
    described: Sequence[str] = (),
) -> list[str]:
    """A comment that tells what a function returns, and which of the user's names each entry of its inputs has.

    Args:
        record: Names of the model.
        title: First line.
        inputs: Input groups.
        returns: Name and shape of each output.
        described: Descriptions of output entries, in their order.
    """
    names = {
        "q": record.q_names,
        "v": record.v_names,
        "a": record.v_names,  # The rate of the speed of that name.
        "u": record.u_names,
        "par": record.par_names,
    }
    lines = ["/* " + comment(title)]
    for group in inputs:
        lines += _wrapped([f"{group}[{i}] {name}" for i, name in enumerate(names.get(group, ()))])
    lines += _wrapped(described)
    if returns:
        lines.append(f" *   -> {', '.join(_shaped(name, shape) for name, shape in returns)}")
    return [*lines, " */"] if len(lines) > 1 else []


def _wrapped(entries: Iterable[str]) -> list[str]:
    """Lines of a comment that break between entries, not within one."""
    text = ", ".join(comment(entry).replace(" ", _SPACE) for entry in entries)
    lines = wrap(text, _WIDTH, break_long_words=False, break_on_hyphens=False)
    return [f" *   {line.replace(_SPACE, ' ')}" for line in lines]


def _described_pre(program: Program, record: ModelRecord) -> list[str]:
    """Entries of pre by their names in the graph, or else by the parameters they depend on; equal ones as a range."""
    graph = program.graph
    parameters = {node: frozenset([slot.index]) for node, slot in graph.slot.items() if slot.group == "par"}
    for node in needed_nodes(graph, program.init):
        parameters[node] = frozenset().union(*(parameters.get(abs(arg), frozenset()) for arg in graph.args[node]))

    def described(edge: Edge) -> str:
        names = [record.par_names[i] for i in sorted(parameters.get(abs(edge), ()))]
        stated = f"of {' '.join(names[:_MAX_NAMES])}{' ...' if len(names) > _MAX_NAMES else ''}"
        return graph.label.get(abs(edge), stated)

    entries, first = [], 0
    for description, run in groupby(map(described, program.init)):
        last = first + len(list(run)) - 1
        entries.append(f"pre[{first}{f'..{last}' if last > first else ''}] {description}")
        first = last + 1
    return entries


def _shaped(name: str, shape: tuple[int, ...]) -> str:
    """An array as comments state it: "M[6 x 6] by rows", "h[6]", "T"."""
    sizes = " x ".join(map(str, shape))
    return f"{name}[{sizes}]{' by rows' * (len(shape) > 1)}" if shape else name


def _one_function(
    program: Program,
    record: ModelRecord,
    function: Function,
    c_name: str,
    in_lanes: LaneOptions | None,
    packs: Packs,
    sparse: SparseSystem | None,
    chosen: tuple[Choice, ...],
) -> tuple[str, _Row]:
    """The code of a function, with its rows of tables; `chosen` is how it is formed."""
    inputs = ["pre", *function.inputs]
    vectors, scratch = [], 0
    if function.solver is not None:
        in_lanes = None
        text = with_solver(program, c_name, function, function.solver, packs, sparse)
    else:
        writer = FunctionWriter(program, c_name, inputs, function.outputs, packs=packs, limbs=packs != "none")
        if writer.has_packs and writer.choices[0].method != "packs":
            without = FunctionWriter(program, c_name, inputs, function.outputs, limbs=True)
            text = _text_of_one_state(writer, without)
        else:
            text = writer.text()
        if in_lanes is not None:
            scalars = FunctionWriter(program, c_name, inputs, function.outputs) if packs != "none" else writer
            on_vectors = scalars.text_on_vectors(in_lanes)
            strided = lanes.strided(c_name, program, function, on_vectors.work, in_lanes)
            vectors = ["#if SYM_LANES > 1", on_vectors.code, strided, "#endif"]
            scratch = lanes.scratch(program, function, on_vectors.work, in_lanes)
            if in_lanes.are_all:
                otherwise = lanes.one_state(c_name, function)
                text = replace(text, code="\n".join(["#if SYM_LANES > 1", otherwise, "#else", text.code, "#endif"]))
    work = max(text.work, scratch)
    title = f"{function.name} {function.frame}".rstrip()
    described = f"{title}: {function.summary}" if function.summary else title
    batch = lanes.batch(c_name, function, in_lanes)
    head = legend(record, described, function.inputs, function.returns)
    code = "\n".join([*head, text.code, *vectors, batch])
    arrays_in = ", ".join(f'{{"{name}", 1, {program.sizes[name]}, 1}}' for name in inputs)
    arrays_out = ", ".join(f'{{"{name}", {len(s)}, {_rows(s)}, {_columns(s)}}}' for name, s in function.returns)
    tables = (
        f"static const sym_array {c_name}_in[] = {{{arrays_in}}};\n"
        f"static const sym_array {c_name}_out[] = {{{arrays_out}}};"
    )
    of_lanes = f"    {{sizeof(sym_number), SYM_OWN, {work}, {c_name}_lanes}}" if vectors else "    {0, 0, 0, NULL}"
    return code, _Row(tables, _row(function, c_name, len(inputs), work), of_lanes, chosen + text.choices)


def _text_of_one_state(packed: FunctionWriter, without: FunctionWriter) -> FunctionText:
    """A function whose packs hardly pay: with them only where the processor's vectors have up to 256 bits."""
    plain = without.text()
    vectors, _ = packed.choices
    if vectors.method == "scalars":
        return replace(plain, choices=(vectors, *plain.choices[1:]))
    text = packed.text()
    code = "\n".join(["#if SYM_PART < 8", text.code, "#else", plain.code, "#endif"])
    return FunctionText(code, max(text.work, plain.work), (vectors, *plain.choices[1:]))


def _row(function: Function, c_name: str, n_in: int, work: int) -> str:
    frame = c_string(function.frame) if function.frame else "NULL"
    return (
        f"    {{{c_string(function.name)}, {frame}, {n_in}, {len(function.returns)}, {c_name}_in, {c_name}_out, "
        f"{work}, {c_name}, {c_name}_batch}}"
    )


def _function_table(name: str, rows: Sequence[_Row]) -> str:
    return f"static const sym_function {name}_functions[] = {{\n" + ",\n".join(row.row for row in rows) + "\n};"


def _lane_table(name: str, rows: Sequence[_Row], vectors: LaneOptions | None) -> list[str]:
    """The table of functions on vectors, for compilers that have vectors; none where lanes are rows."""
    if vectors is None or vectors.in_rows:
        return []
    table = f"static const sym_lanes {name}_lanes[] = {{\n" + ",\n".join(row.lanes for row in rows) + "\n};"
    return [
        "#if SYM_LANES > 1",
        table,
        "#define SYM_LANE_TABLE(name) name##_lanes",
        "#else",
        "#define SYM_LANE_TABLE(name) NULL",
        "#endif",
    ]


def _rows(shape: tuple[int, ...]) -> int:
    return shape[0] if shape else 1


def _columns(shape: tuple[int, ...]) -> int:
    return shape[1] if len(shape) > 1 else 1


def _numbers(values: Iterable[float]) -> str:
    return ", ".join(map(repr, values)) or "0.0"
