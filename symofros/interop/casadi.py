"""CasADi: forward and inverse dynamics and positions of frames as external functions in C, with exact derivatives.

    dynamics = sf.interop.casadi.Dynamics(system, frames=["tool"])
    a = dynamics.forward_dynamics(q, v, u)      # SX is not possible: MX, DM or numbers
    p = dynamics.frame_position("tool", q)
    x_rate = dynamics.state_derivative(x, u)    # x = (q, v)

The library has CasADi's interface of external functions: `dynamics.library`, and the names `dynamics.names`; acados
takes what `dynamics.write_acados_library` writes. Jacobians, gradients and Hessians are exact and have their structural
zeros: Ipopt takes its exact Hessian. Quaternions may be of any length but zero: functions are those of the unit ones
(docs/theory/linear.md, section 9).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.arguments import check_argument
from symofros.base.functions import FUNCTIONS
from symofros.base.names import identifier
from symofros.base.options import Options
from symofros.base.stored import write_atomically
from symofros.compiler import Compilation
from symofros.description import System
from symofros.errors import CompileError, UnknownNameError, did_you_mean
from symofros.interop.casadi_externals import External, Input, Output, gathered, slopes_of
from symofros.interop.casadi_sources import Sources
from symofros.interop.coordinates import Coordinates, Operations
from symofros.interop.rules import RULES, InteropError, check_functions, framework
from symofros.native import native_text
from symofros.runtime.build import NO_COMPILER, build_library, find_toolchain

casadi = framework("casadi", "casadi")
_OPERATIONS = Operations(
    casadi.vertsplit,
    lambda entries: casadi.vertcat(*entries),
    *(casadi.sqrt, casadi.sin, casadi.cos, casadi.atan2, casadi.if_else),
)


@dataclass(frozen=True)
class _Differentiable:
    """A function, and the functions of the model that give its derivatives.

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
        names = {output.name: group for group, output in FUNCTIONS[self.value[0]].cotangents.items()}
        return names[self.value[1]]

    def functions(self, second_order: bool) -> list[str]:
        """Functions of the model that are called."""
        first = [self.value[0], *(name for name, _ in self.slopes.values())]
        return [*first, self.vjp, self.hessian] if second_order else first


class Dynamics:
    """A system's dynamics for CasADi.

    Args:
        system: System as the user stated it.
        frames: Frames whose positions are functions, too.
        second_order: Whether there are Hessians; they take several times as long to generate. Without them Ipopt needs
            the option "hessian_approximation": "limited-memory", and cvodes and idas have no sensitivities.

    Attributes:
        library: Path of the shared library, with CasADi's own whole numbers.
        names: Name of each function in the library, by ours ("frame_position NAME" of a frame). Names of its Jacobian,
            of its gradient and of their Jacobians begin with jac_, adj1_, jac_jac_ and jac_adj1_.
        functions: Functions of CasADi, by ours; parameters are their last input.

    Raises:
        InteropError: The model has prescribed motions, forces that depend on time or rigid contacts.
        UnknownNameError: There is no such frame.
        CompileError: There is no C compiler, or it refused.
    """

    def __init__(self, system: System, frames: Sequence[str] = (), second_order: bool = True) -> None:
        if isinstance(frames, str):  # A sequence of letters, too.
            check_argument("frames", frames, tuple[str, ...])
        self._given = system, tuple(frames), second_order
        known = Compilation(system)
        check_functions(known.record)
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
        record = known.record
        self._par, self._sizes = record.par_default, (len(record.q_names), len(record.v_names))
        self._entries = {"q": record.q_names, "v": record.v_names, "a": record.v_names}
        self._entries |= {"u": record.u_names, "par": record.par_names}
        self._coordinates = Coordinates(known.record.segments, _OPERATIONS)
        source = _source(compilation, c_name, {self.names[name]: each for name, each in wanted.items()}, second_order)
        self._build = partial(build_library, header=native_text("model/symofros_model.h"), toolchain=toolchain)
        self._c_name, self._source = c_name, source
        self.library: Path = self._build(source)
        self.functions = {name: casadi.external(own, str(self.library)) for name, own in self.names.items()}

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), self._given

    def write_acados_library(self, folder: str | os.PathLike[str]) -> str:
        """Write lib<name>.so for acados, whose whole numbers are `int` where CasADi's are `long long`.

        Args:
            folder: Where it is written: acados' option `model_external_shared_lib_dir`.

        Returns:
            The name without "lib" and ".so": acados' option `model_external_shared_lib_name`.

        Raises:
            CompileError: The C compiler refused.
        """
        built = self._build(f"#define casadi_int int\n{self._source}")
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        write_atomically(place / f"lib{self._c_name}.so", built.read_bytes())
        return self._c_name

    def forward_dynamics(self, q: Any, v: Any, u: Any, par: Any = None) -> Any:
        """Accelerations (nv) of q (nq), v (nv), u (nu), par (npar)."""
        return self._called("forward_dynamics", q=q, v=v, u=u, par=par)

    def inverse_dynamics(self, q: Any, v: Any, a: Any, par: Any = None) -> Any:
        """Efforts M a + h - Q(q, v, 0) (nv) of q, v, a (nv) and par (npar)."""
        return self._called("inverse_dynamics", q=q, v=v, a=a, par=par)

    def state_derivative(self, x: Any, u: Any, par: Any = None) -> Any:
        """Rates (N(q) v; v') (nq + nv) of states x = (q; v), of inputs u (nu) and par (npar).

        They keep the lengths of quaternions, on which nothing depends: a state that starts with unit ones keeps them,
        but for the errors of an integrator, which change no acceleration.
        """
        q, v = casadi.vertsplit(_expression(x), [0, self._sizes[0], sum(self._sizes)])
        return casadi.vertcat(self.coordinate_rates(q, v), self.forward_dynamics(q, v, u, par))

    def coordinate_rates(self, q: Any, v: Any) -> Any:
        """Rates q' = N(q) v (nq) of q (nq), v (nv): v itself but for balls and free joints."""
        return self._coordinates.rates(_expression(q), _expression(v))

    def integrate(self, q: Any, dq: Any) -> Any:
        """Move from q (nq) along the manifold by dq (nv), a velocity times a time: `Model.integrate`."""
        return self._coordinates.integrate(_expression(q), _expression(dq))

    def difference(self, q0: Any, q1: Any) -> Any:
        """The dq (nv) that leads from q0 to q1 (nq): `Model.difference`."""
        return self._coordinates.difference(_expression(q0), _expression(q1))

    def frame_position(self, frame: str, q: Any, par: Any = None) -> Any:
        """Position (3) of a frame's origin in the world [m], of q (nq) and par (npar).

        Raises:
            UnknownNameError: The frame was not asked for.
        """
        if f"frame_position {frame}" not in self.functions:
            asked = [name.removeprefix("frame_position ") for name in self.functions if name not in RULES]
            raise UnknownNameError(
                f"no function of the position of frame '{frame}'",
                ", ".join(asked) or "no frames",
                "frames are those that `frames` of Dynamics names",
                did_you_mean(frame, asked),
            )
        return self._called(f"frame_position {frame}", q=q, par=par)

    def _called(self, function: str, *, par: Any, **given: Any) -> Any:
        """A function of arrays by name.

        Raises:
            InteropError: One has another number of entries: CasADi would repeat a single one, or take zeros for none.
        """
        given["par"] = casadi.DM(self._par) if par is None else par
        for name, value in given.items():
            shape, names = np.shape(value) if not hasattr(value, "shape") else value.shape, self._entries[name]
            if (tuple(shape) or (1,)).count(len(names)) == 0:
                listed = ", ".join(names[:12]) or "it is empty"
                found, rule = f"shape {tuple(shape)}", f"an entry for each of {len(names)}: {listed}"
                raise InteropError(f"{function}: {name} does not fit", found, rule, "give each its entry")
        return self.functions[function](*given.values())


def _expression(x: Any) -> Any:
    """An expression, or numbers as CasADi has them."""
    return x if isinstance(x, (casadi.MX, casadi.SX, casadi.DM)) else casadi.DM(x)


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
    sources = Sources(functions, record.segments)
    texts = [
        compilation.source(c_name),
        native_text("stepping/state/rotations.c"),
        native_text("interop/symofros_casadi.c"),
    ]
    texts.append(sources.segments_text)
    for own, each in wanted.items():
        texts += [external.text(c_name) for external in _externals(own, each, sizes, sources, second_order)]
    return "\n".join(texts)


def _externals(
    own: str, f: _Differentiable, sizes: Mapping[str, int], sources: Sources, second_order: bool
) -> Iterator[External]:
    """A function and its derivatives, as CasADi names and orders their inputs and outputs."""

    def slope(label: str, x: str, **options: Any) -> Output:
        frame = f.frame if FUNCTIONS[f.slopes[x][0]].of_frame else ""
        shape = (sizes[x], f.size) if options else (f.size, sizes[x])
        return gathered(label, sources.slopes(f.slopes[x][0], frame, f.slopes[x][1], x), shape, **options)

    value = f.value[1]
    inputs = tuple(Input(x, sizes[x], x) for x in f.inputs)
    unread = Input(f"out_{value}", f.size)
    yield External(own, inputs, (gathered(value, sources.value(f.value[0], f.frame, value), (f.size, 1)),))
    slopes = [slope(f"jac_{value}_{x}", x) for x in f.inputs]
    yield External(f"jac_{own}", (*inputs, unread), tuple(slopes))
    if not second_order:
        return
    starts = {x: sum(sizes[before] for before in f.inputs[:i]) for i, x in enumerate(f.inputs)}
    unread_slopes = (Input(f"out_{each.label}", like=each) for each in slopes)
    yield External(
        f"jac_jac_{own}", (*inputs, unread, *unread_slopes), _second_derivatives(f, slopes, starts, sizes, sources)
    )
    inputs = (*inputs, unread, Input(f"adj_{value}", f.size, f.cotangent))
    # CasADi takes gradients of the shape of their inputs, which are dense.
    gradient = [gathered(f"adj_{x}", sources.gradient(f.vjp, f.frame, x), (sizes[x], 1), dense=True) for x in f.inputs]
    yield External(f"adj1_{own}", inputs, tuple(gradient))
    curvature = []
    for x in f.inputs:
        for y in f.inputs:
            H = sources.hessian(f.hessian, f.frame, f.vjp)
            curvature.append(gathered(f"jac_adj_{x}_{y}", H, (sizes[x], sizes[y]), (starts[x], starts[y])))
        curvature.append(Output(f"jac_adj_{x}_out_{value}", (sizes[x], f.size)))
        curvature.append(slope(f"jac_adj_{x}_adj_{value}", x, transposed=True))
    unread_gradient = (Input(f"out_adj_{x}", sizes[x]) for x in f.inputs)
    yield External(f"jac_adj1_{own}", (*inputs, *unread_gradient), tuple(curvature))


def _second_derivatives(
    f: _Differentiable, slopes: Sequence[Output], starts: Mapping[str, int], sizes: Mapping[str, int], sources: Sources
) -> tuple[Output, ...]:
    """Derivatives of the Jacobian blocks, from which integrators of stiff equations compute sensitivities."""
    H = sources.hessians(f.hessian, f.frame, f.vjp, f.cotangent, f.size)
    outputs = []
    for x, of in zip(f.inputs, slopes, strict=True):
        m, columns = of.shape
        for y in f.inputs:
            outputs.append(slopes_of(f"jac_{of.label}_{y}", H, of, (starts[x], starts[y]), sizes[y]))
        outputs.append(Output(f"jac_{of.label}_out_{f.value[1]}", (m * columns, f.size)))
    return tuple(outputs)
