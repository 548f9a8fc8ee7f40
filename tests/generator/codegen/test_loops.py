"""Loops over equal parts: the bits of straight code, shorter text, and none where little repeats."""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import symofros as sf
from reference_models.closed.four_bars import n_four_bar, n_four_bar_absolute
from reference_models.rigid.chain import chain
from symofros.base import routes
from symofros.base.functions import FUNCTIONS
from symofros.compiler import Compilation
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import evaluate_edges
from symofros.expr.program import Output, Program
from symofros.generator.codegen import function, loops
from symofros.generator.codegen.function import FunctionWriter
from tests.exports.cases import need

# Nothing is optimised: straight code of rows compiles for many times as long, and has the same bits.
EXACT = ("-O0", "-ffp-contract=off")
INPUTS = 9
# (operation, two operands, whether it is stored); an operand is (kind, number), see `_operand`.
Row = tuple[str, tuple[tuple[str, int], tuple[str, int]], bool]
_OPERANDS = st.tuples(
    st.sampled_from(["own", "previous", "common", "first", "input", "entry", "number", "other number", "mirrored"]),
    st.integers(0, 11),
)
_ROWS = st.tuples(st.sampled_from(["add", "sub", "mul"]), st.tuples(_OPERANDS, _OPERANDS), st.booleans())


# Each part reads a value of the first part, or of the part before: of the first part, its own.
_OF_PART_0, _OF_PART_BEFORE = (
    [
        ("add", (("entry", 0), ("number", 1)), True),
        ("mul", (("own", 0), ("entry", 1)), True),
        ("mul", ((kind, 0), ("own", 1)), True),
    ]
    for kind in ("first", "previous")
)


def repeated(rows: list[Row], count: int) -> tuple[Program, tuple[Output, ...]]:
    """A function, and its outputs, that does the rows in turn for each of several parts, twice."""
    graph = Graph()
    # Operands stand in the order of their creation: inputs and numbers before all parts, so that parts are alike.
    inputs = [graph.input("q", i) for i in range(INPUTS)]
    for number in range(12):
        graph.constant(0.25 + number)
    common = [graph.add(inputs[i], graph.constant(0.3 + i)) for i in range(3)]
    before: list[list[Edge]] = []
    stored: list[Edge] = []
    for _ in range(2):
        parts: list[list[Edge]] = []
        for part in range(count):
            own: list[Edge] = []
            for operation, operands, is_stored in rows:
                pair = (_operand(graph, operand, part, own, parts, before, common) for operand in operands)
                edge = getattr(graph, operation)(*pair)
                own.append(edge if abs(edge) not in graph.value else common[0])
                stored += [own[-1]] * is_stored
            parts.append(own)
        before = parts
    outputs = (Output("y", (len(stored),), tuple(stored)), Output("z", (len(before),), tuple(p[-1] for p in before)))
    return Program("repeated", graph, {"q": INPUTS}, ()), outputs


def _operand(
    graph: Graph,
    operand: tuple[str, int],
    part: int,
    own: list[Edge],
    parts: list[list[Edge]],
    before: list[list[Edge]],
    common: list[Edge],
) -> Edge:
    kind, number = operand
    # Of the first part, the part before and the first part are itself.
    sources = {"own": own, "previous": parts[-1] if parts else own, "first": parts[0] if parts else own}
    if kind in sources and own:
        return sources[kind][number % len(own)]
    if kind == "mirrored" and before:
        return before[-1 - part][number % len(before[0])]
    if kind == "entry":
        return graph.input("q", (number + 2 * part) % INPUTS)
    if kind == "number":
        return graph.constant(0.25 + number)
    if kind == "other number":
        return graph.constant(0.7 + 0.1 * number * part)
    return graph.input("q", number % INPUTS) if kind == "input" else common[number % len(common)]


def compiled(text: str, work: int, folder: Path) -> Callable[..., list[np.ndarray]]:
    """The function f of a text, called by its input and the sizes of its outputs."""
    need("gcc")
    head = "#include <string.h>\n#define SYM_NOINLINE __attribute__((noinline))\n"
    call = "\nvoid call(const double *const *in, double *const *out, double *work) { f(in, out, work); }\n"
    (folder / "f.c").write_text(head + text + call)
    library = folder / f"f{len(list(folder.iterdir()))}.so"
    flags = ("-O0", "-ffp-contract=off", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-shared", "-fPIC")
    subprocess.run(["gcc", *flags, "f.c", "-o", library.name], cwd=folder, check=True)
    f = ctypes.CDLL(str(library)).call

    def run(q: np.ndarray, *sizes: int) -> list[np.ndarray]:
        outputs = [np.full(size, np.nan) for size in sizes]
        scratch = np.full(max(1, work), np.nan)
        pointers = (ctypes.c_void_p * len(outputs))(*(array.ctypes.data for array in outputs))
        f((ctypes.c_void_p * 1)(q.ctypes.data), pointers, ctypes.c_void_p(scratch.ctypes.data))
        return outputs

    return run


@settings(max_examples=40)
@given(st.lists(_ROWS, min_size=1, max_size=12), st.integers(2, 9), st.integers(0, 3))
@example(_OF_PART_0, 9, 0)
@example(_OF_PART_BEFORE, 9, 0)
def test_loops_compute_the_bits_of_the_graph(
    tmp_path_factory: pytest.TempPathFactory, rows: list[Row], count: int, seed: int
) -> None:
    """Whatever the parts read: own values, those of the part before, the first, the opposite one, numbers, inputs."""
    program, outputs = repeated(rows, count)
    sizes = [len(output.edges) for output in outputs]
    q = np.random.default_rng(seed).uniform(-1.0, 1.0, INPUTS)
    expected = [
        [float(np.ravel(value)[0]) for value in evaluate_edges(program, output.edges, {"q": q[None]}, {})]
        for output in outputs
    ]
    with pytest.MonkeyPatch.context() as patch:
        for name, least in {"FEWEST": 2, "MIN_SPARED": 1, "SEED": 2}.items():
            patch.setattr(loops, name, least)
        patch.setattr(routes, "MIN_REPEATED", 1)
        patch.setattr(routes, "REPEATED_SHARE", 0.0)
        patch.setattr(function, "MAX_STATEMENTS", 20)
        text = FunctionWriter(program, "f", ["q"], outputs, False).text()
    run = compiled(text.code, text.work, tmp_path_factory.mktemp("loops"))
    for values, exact in zip(run(q, *sizes), expected, strict=True):
        np.testing.assert_array_equal(values, exact)


def unlike_rows(n: int) -> sf.System:
    """Pendulums side by side, each of two links with lengths and masses of its own."""
    bodies = []
    for i in range(n):
        rod = sf.Inertia(1.0 + 0.1 * i, (0.5, 0.1, 0.0), (0.03, 1.0 / 12, 0.1))
        upper = sf.Joint(f"a{i}", "revolute", position=(i * i, 0, 0), axis=(0, 1, 0))
        bodies.append(sf.RigidBody(f"upper{i}", upper, rod, (sf.Frame("end", (1.0 + 0.2 * i, 0, 0)),)))
        bodies.append(sf.RigidBody(f"lower{i}", sf.Joint(f"b{i}", "revolute", f"upper{i}", "end", axis=(1, 0, 0)), rod))
    return sf.System(f"pendulums{n}", bodies)


CLOSED = ("constraint", "constraint_rate", "constraint_jacobian", "forward_dynamics", "kinetic_energy")
REPETITIVE = {
    "row of four-bars": (n_four_bar(20), CLOSED),
    "four-bars in absolute coordinates": (n_four_bar_absolute(12), CLOSED),
    "pendulums": (unlike_rows(16), ("inverse_dynamics", "forward_dynamics", "kinetic_energy")),
}


def straight(patch: pytest.MonkeyPatch) -> None:
    """No loops from here on."""
    patch.setattr(function, "with_loops", lambda _, statements: (list(statements), 0))


@pytest.mark.parametrize("case", REPETITIVE)
def test_loops_have_the_bits_of_straight_code(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without contraction, which may fuse a product with a sum only where memory does not come between them."""
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    system, functions = REPETITIVE[case]
    options = sf.Options(functions=functions, flags=EXACT, packs=False)
    looped = Compilation(system, options)
    assert re.search(r"for \(i = 0; i < \d\d; \+\+i\)", looped.source())
    models = [looped.model()]
    rng = np.random.default_rng(2)
    states = [models[0].random_state(rng) for _ in range(5)]
    q, v = np.array([q for q, _ in states]), np.array([v for _, v in states])
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "straight"))
    straight(monkeypatch)
    models.append(sf.compile(system, options))
    inputs = {"q": q, "v": v, "a": rng.standard_normal(v.shape)}
    for name in functions:
        given_ones = {x: y for x, y in inputs.items() if x in FUNCTIONS[name].inputs}
        first, second = (model.evaluate(name, **given_ones) for model in models)
        for looped_values, straight_values in zip(first, second, strict=True):
            assert np.isfinite(looped_values).all(), name
            np.testing.assert_array_equal(looped_values, straight_values, err_msg=name)


def test_the_text_does_not_grow_with_the_row() -> None:
    """Lines of code, without the tables and the legends, which grow with the number of entries."""

    def lines(n: int) -> int:
        text = Compilation(n_four_bar(n), sf.Options(functions=("constraint_jacobian",))).source()
        return len(text.partition("_constraint_jacobian_f0_0(")[2].partition("\n}")[0].splitlines())

    assert lines(80) == lines(40)


def test_loops_are_not_formed_where_little_repeats(monkeypatch: pytest.MonkeyPatch) -> None:
    """M of a chain: rows of different lengths."""
    stated = Compilation(chain(13, symbolic=False), sf.Options(functions=("mass_matrix",)))
    text = stated.source()
    straight(monkeypatch)
    assert stated.source() == text
