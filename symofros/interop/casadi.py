"""CasADi: forward and inverse dynamics and positions of frames as external functions in C, with exact derivatives.

    dynamics = sf.interop.casadi.Dynamics(system, frames=["tool"])
    a = dynamics.forward_dynamics(q, v, u)      # SX is not possible: MX, DM or numbers
    p = dynamics.frame_position("tool", q)

The library has CasADi's interface of external functions: `dynamics.library`, and the names `dynamics.names`; acados
takes what `dynamics.write_acados_library` writes. Jacobians, gradients and Hessians are exact and have their structural
zeros: Ipopt takes its exact Hessian.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from symofros.base.arguments import check_argument
from symofros.base.atomic import write_atomically
from symofros.base.functions import FUNCTIONS
from symofros.base.model_function import cotangents
from symofros.base.options import Options
from symofros.compiler import Compilation
from symofros.description.system import System
from symofros.errors import CompileError, Problem, UnknownNameError, did_you_mean
from symofros.expr.program import Function
from symofros.generator.codegen.names import identifier
from symofros.interop.casadi_externals import External, Input, Output, gathered
from symofros.interop.rules import RULES, check_record, framework
from symofros.native import native_text
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import NO_COMPILER, find_toolchain

casadi = framework("casadi", "casadi")


@dataclass(frozen=True)
class _Differentiable:
    """A function with what gives its derivatives.

    Attributes:
        value: Function of the model and the array that it gives.
        size: Number of entries of the value.
        inputs: Input groups, in the order of the Hessian's.
        slopes: Function and array of the derivative by each input; of the rows the first `size` count.
        hessian: Function of the second derivatives.
        frame: Frame, or "".
    """

    value: tuple[str, str]
    size: int
    inputs: tuple[str, ...]
    slopes: Mapping[str, tuple[str, str]]
    hessian: str
    frame: str = ""

    @property
    def vjp(self) -> str:
        """Function of the vector-Jacobian products."""
        return f"{self.value[0]}_vjp"

    @property
    def cotangent(self) -> str:
        """Input group of the value's cotangent."""
        names = {output.name: group for group, output in cotangents(FUNCTIONS[self.value[0]]).items()}
        return names[self.value[1]]

    def functions(self, second_order: bool) -> list[str]:
        """Functions of the model that are called."""
        first = [self.value[0], *(name for name, _ in self.slopes.values())]
        return [*first, self.vjp, self.hessian] if second_order else first


class Dynamics:
    """A system's dynamics for CasADi.

    Args:
        system: System as the user stated it, whose speeds are the rates of its coordinates.
        frames: Frames whose positions are functions, too.
        second_order: Whether there are Hessians; they take several times as long to generate. Without them Ipopt needs
            the option "hessian_approximation": "limited-memory".

    Attributes:
        library: Path of the shared library, with CasADi's own whole numbers.
        names: Name of each function in the library, by ours ("frame_position NAME" of a frame). Names of its Jacobian,
            of its gradient and of that one's Jacobian begin with jac_, adj1_ and jac_adj1_.
        functions: Functions of CasADi, by ours; parameters are their last input.

    Raises:
        InteropError: The model has quaternions, prescribed motions or forces that depend on time.
        UnknownNameError: There is no such frame.
        CompileError: There is no C compiler, or it refused.
    """

    def __init__(self, system: System, frames: Sequence[str] = (), second_order: bool = True) -> None:
        if isinstance(frames, str):  # A sequence of letters, too.
            check_argument("frames", frames, tuple[str, ...])
        known = Compilation(system)
        check_record(known.record)
        wanted = _differentiable(len(known.record.v_names))
        needed = {name for each in wanted.values() for name in each.functions(second_order)}
        placed = _position("")
        of_frames = set(placed.functions(second_order)) if len(frames) else set()
        compilation = Compilation(system, Options(tuple(sorted(needed | of_frames)), tuple(frames)))
        _ = compilation.requests  # Refuses frames that do not exist.
        wanted |= {f"frame_position {name}": _position(compilation.tree.frame(name).name) for name in frames}
        toolchain = find_toolchain(None)
        if toolchain is None:
            raise CompileError(NO_COMPILER)
        c_name = identifier(system.name)
        self.names = {name: f"{c_name}_{identifier(name.replace(' ', '_'))}" for name in wanted}
        self._par = known.record.par_default
        source = _source(compilation, c_name, {self.names[name]: each for name, each in wanted.items()}, second_order)
        self._build = partial(build_library, header=native_text("model/symofros_model.h"), toolchain=toolchain)
        self._c_name, self._source, self._symbol = c_name, source, f"{c_name}_model"
        self.library: Path = self._build(source, symbol=self._symbol)
        self.functions = {name: casadi.external(own, str(self.library)) for name, own in self.names.items()}

    def write_acados_library(self, folder: str | os.PathLike[str]) -> str:
        """Write lib<name>.so for acados, whose whole numbers are `int` where CasADi's are `long long`.

        Args:
            folder: Where it is written: acados' option `model_external_shared_lib_dir`.

        Returns:
            The name without "lib" and ".so": acados' option `model_external_shared_lib_name`.

        Raises:
            CompileError: The C compiler refused.
        """
        built = self._build(f"#define casadi_int int\n{self._source}", symbol=self._symbol)
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        write_atomically(place / f"lib{self._c_name}.so", built.read_bytes())
        return self._c_name

    def forward_dynamics(self, q: Any, v: Any, u: Any, par: Any = None) -> Any:
        """Accelerations (nv) of q (nq), v (nv), u (nu), par (npar)."""
        return self.functions["forward_dynamics"](q, v, u, self._parameters(par))

    def inverse_dynamics(self, q: Any, v: Any, a: Any, par: Any = None) -> Any:
        """Efforts M a + h - Q(q, v, 0) (nv) of q, v, a (nv) and par (npar)."""
        return self.functions["inverse_dynamics"](q, v, a, self._parameters(par))

    def frame_position(self, frame: str, q: Any, par: Any = None) -> Any:
        """Position (3) of a frame's origin in the world [m], of q (nq) and par (npar).

        Raises:
            UnknownNameError: The frame was not asked for.
        """
        function = self.functions.get(f"frame_position {frame}")
        if function is None:
            asked = [name.removeprefix("frame_position ") for name in self.functions if name not in RULES]
            raise UnknownNameError(
                Problem(
                    f"no function of the position of frame '{frame}'",
                    ", ".join(asked) or "no frames",
                    "frames are those that `frames` of Dynamics names",
                    did_you_mean(frame, asked),
                )
            )
        return function(q, self._parameters(par))

    def _parameters(self, par: Any) -> Any:
        return casadi.DM(self._par) if par is None else par


def _differentiable(nv: int) -> dict[str, _Differentiable]:
    """The functions that every model has, by name."""
    return {
        name: _Differentiable(
            (name, FUNCTIONS[name].outputs[0].name), nv, rule.inputs, rule.derivatives, f"{name}_hessian"
        )
        for name, rule in RULES.items()
    }


def _position(frame: str) -> _Differentiable:
    """The position of a frame."""
    slopes = {"q": ("frame_jacobian", "J"), "par": ("frame_position_by_par", "by_par")}
    return _Differentiable(("frame_pose", "p"), 3, ("q", "par"), slopes, "frame_position_hessian", frame)


def _source(compilation: Compilation, c_name: str, wanted: Mapping[str, _Differentiable], second_order: bool) -> str:
    """C text of the model and of the external functions."""
    record = compilation.record
    nv = len(record.v_names)
    sizes = {"q": len(record.q_names), "v": nv, "u": len(record.u_names), "a": nv, "par": len(record.par_names)}
    functions = {(function.name, function.frame): function for function in compilation.program.functions}
    texts = [compilation.source(c_name), native_text("interop/symofros_casadi.c")]
    for own, each in wanted.items():
        texts += [external.text(c_name) for external in _externals(own, each, sizes, functions, second_order)]
    return "\n".join(texts)


def _externals(
    own: str,
    f: _Differentiable,
    sizes: Mapping[str, int],
    functions: Mapping[tuple[str, str], Function],
    second_order: bool,
) -> Iterator[External]:
    """A function and its derivatives, as CasADi names and orders their inputs and outputs."""

    def block(label: str, name: str, array: str, *shape: int, **options: Any) -> Output:
        frame = f.frame if FUNCTIONS[name].of_frame else ""
        return gathered(label, functions[name, frame], array, (shape[0], shape[1]), **options)

    value = f.value[1]
    inputs = tuple(Input(x, sizes[x], x) for x in f.inputs)
    unread = Input(f"out_{value}", f.size)
    yield External(own, inputs, (block(value, *f.value, f.size, 1),))
    slopes = [block(f"jac_{value}_{x}", *f.slopes[x], f.size, sizes[x]) for x in f.inputs]
    yield External(f"jac_{own}", (*inputs, unread), tuple(slopes))
    if not second_order:
        return
    inputs = (*inputs, unread, Input(f"adj_{value}", f.size, f.cotangent))
    # CasADi takes gradients of the shape of their inputs, which are dense.
    gradient = [block(f"adj_{x}", f.vjp, f"by_{x}", sizes[x], 1, dense=True) for x in f.inputs]
    yield External(f"adj1_{own}", inputs, tuple(gradient))
    starts = {x: sum(sizes[before] for before in f.inputs[:i]) for i, x in enumerate(f.inputs)}
    curvature = []
    for x in f.inputs:
        for y in f.inputs:
            at = starts[x], starts[y]
            curvature.append(block(f"jac_adj_{x}_{y}", f.hessian, "H", sizes[x], sizes[y], first=at))
        curvature.append(Output(f"jac_adj_{x}_out_{value}", (sizes[x], f.size)))
        label = f"jac_adj_{x}_adj_{value}"
        curvature.append(block(label, *f.slopes[x], sizes[x], f.size, transposed=True))
    unread_gradient = (Input(f"out_adj_{x}", sizes[x]) for x in f.inputs)
    yield External(f"jac_adj1_{own}", (*inputs, *unread_gradient), tuple(curvature))
