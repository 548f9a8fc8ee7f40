"""The symbolic peers: C that CasADi makes of recursive dynamics, and SymPy of Kane's equations."""

from __future__ import annotations

import ctypes
import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from ...mechanics.geometry import Array
from ..record import Cost
from ..task import Loop, Task
from .arrays import Arrays, Turns, loops
from .programs import Built, Compiler, Skipped, build, compilers, copies
from .source import Source

# Straight-line code is erratic: between builds of one source, times differ by half. The best of these counts.
BUILDS = (("-O3",), ("-O3", "-ffast-math"))
_FLAGS = ("-march=native", "-std=gnu99", '-DCASADI_SYMBOL_EXPORT=__attribute__((visibility("default")))')
# Kane's equations of SymPy grow out of hand: two bodies in space take 0.3 s, four 4 s, seven minutes.
MAX_KANE = 4
# CasADi's derivatives of larger models are long to compile, and those by quaternions are by four numbers.
MAX_DERIVED = 10


def casadi_loops(task: Task, functions: Sequence[str]) -> Iterator[Loop]:
    """Each function by each build.

    Raises:
        Skipped: The recursions have no equations for the model.
    """
    from ...adapters.casadi import code as casadi_code  # Who lacks CasADi has the rest.
    from ...adapters.casadi import tree as casadi_tree  # As above.

    if task.assembly.nv > MAX_DERIVED and any(name.endswith(("derivatives", "vjp")) for name in functions):
        raise Skipped(f"derivatives are made up to {MAX_DERIVED} degrees of freedom, beyond which they take minutes")

    def make(name: str) -> Source:
        start = time.thread_time()
        function = casadi_tree.CasadiTree(task.system).function(name, task.body)
        text = casadi_code.c_text(function)
        seconds = time.thread_time() - start
        sizes = tuple(int(function.numel_out(i)) for i in range(function.n_out()))
        iwork, work = casadi_code.work_sizes(function)
        operations = casadi_code.operations(function)
        return Source(name, text, ("q", "v", "a", "tau"), sizes, (work, iwork), operations, seconds)

    if task.system.constraints:
        raise Skipped("the recursions are for trees")
    try:
        casadi_tree.CasadiTree(task.system)
    except ValueError as error:
        raise Skipped(str(error)) from None
    yield from _built(task, [name for name in functions if name != "step"], make)


def sympy_loops(task: Task, functions: Sequence[str]) -> Iterator[Loop]:
    """M, h, both and forward dynamics by each build.

    Raises:
        Skipped: The model is too large, or not for SymPy's mechanics.
    """
    if task.system.constraints:
        raise Skipped("Kane's equations are made for trees here")
    if task.assembly.nv > MAX_KANE:
        raise Skipped(
            f"{task.assembly.nv} degrees of freedom: Kane's equations by SymPy are made up to {MAX_KANE}, "
            "beyond which generation takes minutes; see the costs"
        )
    from .kane import FUNCTIONS, kane_source  # SymPy's mechanics take a second.

    yield from _built(task, [name for name in functions if name in FUNCTIONS], partial(kane_source, task.system))


def _built(task: Task, names: Sequence[str], make: Callable[[str], Source]) -> Iterator[Loop]:
    ways = [(compiler, flags) for compiler in compilers() for flags in BUILDS]
    for name in names:
        made = make(name)
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # Compilers are processes of their own.
            builds = list(pool.map(partial(_compiled, made.text), ways))
        for (compiler, flags), built in zip(ways, builds, strict=True):
            yield _loop(task, made, f"{compiler.name} {' '.join(flags)}", built)


def _compiled(text: str, way: tuple[Compiler, tuple[str, ...]]) -> Built:
    compiler, flags = way
    return build(compiler, {"function.c": text}, (*flags, *_FLAGS))


def _loop(task: Task, made: Source, how: str, built: Built) -> Loop:
    ffi, native = loops()
    libraries = [ctypes.CDLL(str(copy)) for copy in copies(built.path)]
    addresses = [ctypes.cast(library[made.name], ctypes.c_void_p).value for library in libraries]
    kind = "int (*)(const double **, double **, long long *, double *, int)"
    functions = [ffi.cast(kind, address) for address in addresses]
    states = task.states
    given = {"q": states.q, "v": states.v, "a": states.a, "tau": states.applied}
    arrays = Arrays([given[name] for name in made.inputs], made.sizes, made.scratch)
    filled = arrays.overwritten()
    run = Turns([partial(native.loop_casadi, function, filled) for function in functions])

    def results() -> Array:
        assert libraries  # Named here, so that it stays loaded.
        return arrays.results(lambda kept: native.loop_casadi(functions[0], kept, 1))

    return Loop(made.name, how, run, results, _cost(made, built, arrays))


def _cost(made: Source, built: Built, arrays: Arrays) -> Cost:
    return Cost(
        made.seconds, built.seconds, len(made.text), built.text, built.constants, made.operations, arrays.memory
    )
