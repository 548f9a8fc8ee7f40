"""Pinocchio's C++ and MuJoCo's C, each built in the run around the headers and libraries of its wheel."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import cffi
import numpy as np

import symofros as sf

from ...contract.conventions import Chart
from ...contract.interface import Subject, Unsupported
from ...mechanics.assembly import Assembly
from ...mechanics.geometry import Array, matrix_quaternion, quaternion_product
from ..task import START, STEP, Loop, Task, flat
from .programs import (
    BuildError,
    Built,
    Compiler,
    Say,
    Skipped,
    build,
    compilers,
    copies,
    declared,
    silent,
    source,
)

PINOCCHIO_FLAGS = (
    "-std=c++17",
    "-O3",
    "-march=native",
    "-DNDEBUG",
    # Pinocchio's variant of joints needs longer lists than Boost's headers hold by default.
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-fvisibility-inlines-hidden",
    "-Wno-deprecated-declarations",  # Its constraints say that their interface will change.
)
MUJOCO_FLAGS = ("-std=gnu99", "-O3", "-march=native", "-Wall", "-Wextra")
_SYSTEM_EIGEN = Path("/usr/include/eigen3")


@cache
def _interface() -> Any:
    ffi = cffi.FFI()
    ffi.cdef(declared("loop.h") + "const loop_engine *loop_open(const char *path, int32_t body);")
    return ffi


# Conditions of a loop's model: Pinocchio factors all of them as one full matrix, which takes seconds a state beyond.
MAX_CONDITIONS = 200
TREES, CLOSED = "loop_pinocchio.cpp", "loop_closed.cpp"


def pinocchio_builds(program: str = TREES, say: Say = silent) -> tuple[list[tuple[Compiler, Built]], list[str]]:
    """Pinocchio by each compiler of this machine, and why others failed.

    Args:
        program: Program for trees or for closed loops; each takes minutes to compile.
        say: Told of what is being compiled.

    Raises:
        Skipped: Headers are missing, or no compiler could.
    """
    sources = {name: source(name) for name in (program, "pinocchio_tree.h", "loop.h", "tree_file.h")}
    # System headers: warnings of other people's code are not ours to show.
    flags = [*PINOCCHIO_FLAGS, *(f"-isystem{path}" for path in _includes())]
    version = (metadata.version("pin"),)
    built: list[tuple[Compiler, Built]] = []
    failures: list[str] = []
    with ThreadPoolExecutor() as pool:
        jobs = {
            compiler: pool.submit(build, compiler, sources, flags, (), version, say) for compiler in compilers("c++")
        }
    for compiler, job in jobs.items():
        try:
            built.append((compiler, job.result()))
        except BuildError as error:
            failures.append(f"Pinocchio by {compiler.name}: {error}")
    if not built:
        raise Skipped("\n".join(failures) or "no C++ compiler was found: install g++ or clang++")
    return built, failures


def _includes() -> list[Path]:
    """Include folders of Pinocchio, Boost and Eigen: those of wheels; without Eigen's wheel, the system's."""
    headers = [_headers("libpinocchio", "pinocchio/algorithm/crba.hpp")]
    try:
        headers.append(_headers("cmeel-eigen", "Eigen/Core"))
    except Skipped:
        if not (_SYSTEM_EIGEN / "Eigen/Core").exists():
            raise
        headers.append(_SYSTEM_EIGEN)
    return list(dict.fromkeys(headers))


def _headers(package: str, header: str) -> Path:
    try:
        listed = metadata.files(package) or []
    except metadata.PackageNotFoundError:
        raise Skipped(f"the package {package} is not installed: pip install 'symofros[timing]'") from None
    match = next((Path(str(f.locate())) for f in listed if str(f).endswith(header)), None)
    if match is None:
        raise Skipped(f"the package {package} has no {header}")
    return match.parents[header.count("/")]


def pinocchio_loops(task: Task, functions: Sequence[str], warn: Callable[[str], None]) -> Iterator[Loop]:
    """Each function by each compiler and convention.

    Args:
        task: The model.
        functions: Names of the functions.
        warn: Told of compilers that failed, if others did not.

    Raises:
        Skipped: Pinocchio can't be built.
    """
    conditions = sum(len(constraint.conditions) for constraint in task.system.constraints)
    if conditions > MAX_CONDITIONS:
        raise Skipped(f"{conditions} conditions: timed up to {MAX_CONDITIONS}, beyond which a state takes seconds")
    builds, failures = pinocchio_builds(CLOSED if task.system.constraints else TREES)
    for failure in failures:
        warn(failure)
    states, convert = task.states, _Converted(None, task)
    with tempfile.TemporaryDirectory() as private:
        tree = Path(private) / "tree.txt"
        tree.write_text(tree_text(task.assembly), encoding="ascii")
        if task.system.constraints:
            Path(f"{tree}.ties").write_text(_ties_text(task), encoding="ascii")
        for compiler, built in builds:
            rows = {"q": states.q, "v": states.v, "a": states.a, "tau": states.applied}
            yield from _loops(copies(built.path, 1)[0], tree, task.body, rows, functions, compiler.name, convert)


def _ties_text(task: Task) -> str:
    """Number of Pinocchio's rigid constraints and a line for each, for `validation/native/loop_closed.cpp`."""
    from ...adapters.pinocchio import loops as pinocchio_loops  # Who lacks Pinocchio has the rest.

    engine = pinocchio_loops.build(Subject(task.label, task.system))
    if isinstance(engine, Unsupported):
        raise Skipped(engine.reason)
    return "\n".join([str(len(engine.ties)), *engine.ties_as_numbers()]) + "\n"


def mujoco_loops(task: Task, functions: Sequence[str]) -> Iterator[Loop]:
    """Each function by MuJoCo's library.

    Raises:
        Skipped: MuJoCo has no such model, or is not installed.
    """
    from ...adapters.mujoco import tree as mujoco  # Who lacks MuJoCo has the rest.

    if task.system.constraints:
        raise Skipped("its closures are soft: accelerations are others")
    engine = mujoco.build(Subject(task.label, task.system))
    if isinstance(engine, Unsupported):
        raise Skipped(engine.reason)
    chart, states = engine.chart, task.states
    rows = {
        "q": chart.coordinates(states.q),
        "v": chart.speeds(states.q, states.v),
        "a": chart.accelerations(states.q, states.v, states.a),
        "tau": chart.forces(states.q, states.applied),
    }
    body = int(engine.model.body(task.frame).id)
    with tempfile.TemporaryDirectory() as private:
        model = Path(private) / "model.mjb"
        mujoco.write(engine, model)
        yield from _loops(_mujoco_built().path, model, body, rows, functions, "", _Converted(chart, task))


def _mujoco_built() -> Built:
    spec, available = find_spec("mujoco"), compilers()
    if spec is None or spec.origin is None:
        raise Skipped("the package mujoco is not installed: pip install 'symofros[timing]'")
    package = Path(spec.origin).parent
    libraries = sorted(package.glob("libmujoco.so*"))
    if not libraries or not available:
        raise Skipped(f"MuJoCo's wheel has no libmujoco.so in {package}" if available else "no C compiler was found")
    sources = {name: source(name) for name in ("loop_mujoco.c", "loop.h")}
    link = (str(libraries[-1]), f"-Wl,-rpath,{package}")
    try:
        return build(
            available[0],
            sources,
            (*MUJOCO_FLAGS, f"-isystem{package / 'include'}"),
            link,
            (metadata.version("mujoco"),),
        )
    except BuildError as error:
        raise Skipped(str(error)) from None


def _loops(
    library: Path,
    model: Path,
    body: int,
    rows: Mapping[str, Array],
    functions: Sequence[str],
    how: str,
    convert: _Converted,
) -> Iterator[Loop]:
    ffi = _interface()
    opened = ffi.dlopen(str(library))
    engine = opened.loop_open(str(model).encode(), body)
    if engine == ffi.NULL:
        raise BuildError(f"{library.name} can't read its model")
    given = _States(rows, opened)
    for k in range(engine.n):
        function = engine.functions[k]
        name, variant = (ffi.string(text).decode() for text in (function.name, function.variant))
        if name in functions:
            states = given.single if function.once else given.all
            yield Loop(
                name,
                ", ".join(filter(None, (how, variant))),
                partial(_run, function, engine.engine, states),
                partial(_results, function, engine.engine, states, partial(convert, name), given),
            )


def _run(function: Any, engine: Any, states: Any, rounds: int) -> None:
    function.run(engine, states, rounds, _interface().NULL)


def _results(function: Any, engine: Any, states: Any, convert: Callable[[Array], Array], given: _States) -> Array:
    computed = np.zeros((1 if function.once else given.count, function.size))
    function.run(engine, states, 1, _interface().from_buffer("double[]", computed))
    return convert(computed)


class _States:
    """Rows as C takes them; `single` begins with the state where motions start. Keeps what C points to."""

    def __init__(self, rows: Mapping[str, Array], library: Any) -> None:
        self.count, self._kept = len(rows["q"]), [library]
        self.all, self.single = self._filled(rows, 0), self._filled(rows, START)

    def _filled(self, rows: Mapping[str, Array], first: int) -> Any:
        ffi = _interface()
        states = ffi.new("loop_states *")
        states.n, states.step = self.count, STEP
        for name, array in rows.items():
            kept = np.ascontiguousarray(array[first:])
            pointer = ffi.from_buffer("double[]", kept)
            self._kept += [kept, pointer]
            setattr(states, name, pointer)
        return states


@dataclass(frozen=True)
class _Converted:
    """An engine's results in our conventions; without a chart they are the same."""

    chart: Chart | None
    task: Task

    def __call__(self, function: str, computed: Array) -> Array:
        chart, q, v, nv = self.chart, self.task.states.q, self.task.states.v, self.task.assembly.nv
        if chart is None:
            return computed
        if function in ("mass_matrix", "dynamics"):
            M_e = computed[:, : nv * nv].reshape(-1, nv, nv)
            M = chart.mass_matrix(q, M_e)
            return flat(M) if function == "mass_matrix" else flat(M, chart.bias(q, v, computed[:, nv * nv :], M_e))
        if function == "frame_jacobian":
            return flat(chart.jacobian(q, computed.reshape(-1, 1, 6, nv)))
        if function == "bias":
            return self._bias(computed)
        if function == "forward_dynamics":
            return chart.our_accelerations(q, v, computed)
        return chart.our_forces(q, computed) if function == "inverse_dynamics" else self._ended(computed)

    def _ended(self, computed: Array) -> Array:
        """Final q and v of a motion, from the engine's (1, nq + nv)."""
        assert self.chart is not None
        q = np.zeros((1, self.task.assembly.nq))
        for slot in self.chart.slots:
            part = slot.mover.q
            own = computed[:, slot.q : slot.q + part.stop - part.start]
            if slot.grounded:
                X = slot.mover.X_AP
                back = quaternion_product(matrix_quaternion(X.R.T)[None], np.roll(own[:, 3:], -1, axis=1))
                own = np.concatenate([(own[:, :3] - X.p) @ X.R, back], axis=1)
            q[:, part] = own
        v = np.linalg.solve(self.chart.transform(q), computed[:, self.chart.nq :, None])[..., 0]
        return flat(q, np.asarray(v, dtype=np.float64))

    def _bias(self, h_e: Array) -> Array:
        """Free joints turn the axes of their speeds, which M has a part in: ours says which."""
        assert self.chart is not None
        chart, q, v = self.chart, self.task.states.q, self.task.states.v
        M = sf.compile(self.task.system).mass_matrix(q)
        T = chart.transform(q)
        return chart.bias(q, v, h_e, T @ M @ T.swapaxes(-1, -2))


def tree_text(assembly: Assembly) -> str:
    """A model as numbers, for `validation/native/tree_file.h`."""
    lines = ["symofros-tree 1", "gravity " + _numbers(assembly.gravity), f"bodies {len(assembly.movers)}"]
    for mover in assembly.movers:
        merged = mover.merged()
        moments, axes = np.linalg.eigh(merged.J_BC)
        parts: list[Array] = [
            mover.axis,
            mover.X_AP.R,
            mover.X_AP.p,
            np.array([merged.mass]),
            merged.p_BC,
            merged.J_BC,
            moments,
            axes,
        ]
        lines.append(" ".join(["body", str(mover.parent), mover.kind, *map(_numbers, parts)]))
    return "\n".join(lines) + "\n"


def _numbers(values: Array) -> str:
    return " ".join(repr(float(x)) for x in np.ravel(values))
