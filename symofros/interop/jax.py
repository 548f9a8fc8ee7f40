"""JAX: forward and inverse dynamics as custom calls of XLA, with exact derivatives.

    jax.config.update("jax_enable_x64", True)
    dynamics = sf.interop.jax.Dynamics(model)
    a = jax.jit(dynamics.forward_dynamics)(q, v, u)      # (..., nv), float64, on the CPU
    q = dynamics.integrate(q, dt * v)

`jit`, `vmap` (one batch in C), `grad`, `jacfwd`, `jacrev`, `jvp`, `vjp`; XLA calls C without Python in between.
Derivatives are the model's, exact; they are not differentiated again. Quaternions may be of any length but zero:
functions are those of the unit ones (docs/theory/linear.md, section 9).
"""

from __future__ import annotations

import ctypes
import threading
from functools import cache
from pathlib import Path
from typing import Any

from symofros.errors import CompileError
from symofros.interop.coordinates import Operations
from symofros.interop.rules import RULES, InteropError, framework, second_derivatives
from symofros.interop.wrapped import WrappedDynamics
from symofros.native import native_text
from symofros.runtime.build import NO_COMPILER, build_library, find_toolchain
from symofros.runtime.calls import MANY, CompiledKernel, NativeMemory
from symofros.runtime.model import Model

jax = framework("jax", "jax")
jnp = jax.numpy

_LOCK = threading.Lock()
_OPERATIONS = Operations(
    lambda x: [x[..., i] for i in range(x.shape[-1])],
    lambda entries: jnp.stack(jnp.broadcast_arrays(*entries), axis=-1),
    *(jnp.sqrt, jnp.sin, jnp.cos, jnp.arctan2, jnp.where),
)
# Registered names with what must stay loaded; a name stands for the same function in all runs.
_REGISTERED: dict[str, CompiledKernel] = {}


class Dynamics(WrappedDynamics):
    """A model's dynamics for JAX.

    Args:
        model: Compiled model.

    Raises:
        InteropError: The model has prescribed motions or forces that depend on time; or it is not compiled.
    """

    def __init__(self, model: Model) -> None:
        super().__init__(model, _OPERATIONS)
        self._functions = {name: self._differentiable(name) for name in RULES}

    def _apply(self, name: str, *arrays: Any) -> Any:
        *states, par = arrays
        if par is None:
            par = self.model.parameter_values
        elif not isinstance(par, jax.core.Tracer):  # What is traced has no values yet.
            self.model.checked_parameters(par)
        return self._functions[name](*self._given(name, **dict(zip(RULES[name].inputs, (*states, par), strict=True))))

    def _given(self, function: str, **given: Any) -> list[Any]:
        """Arrays of doubles with the same leading dimensions."""
        if not jax.config.jax_enable_x64:
            raise _single(function, "arrays", "jax_enable_x64 is off", 'jax.config.update("jax_enable_x64", True)')
        arrays = []
        for label, x in given.items():
            x = jnp.asarray(x)
            if jnp.issubdtype(x.dtype, jnp.inexact) and x.dtype != jnp.float64:
                raise _single(function, f"'{label}'", str(x.dtype), f"{label}.astype(jax.numpy.float64)")
            self._check_shape(function, label, x.shape)
            arrays.append(x.astype(jnp.float64))
        batch = jnp.broadcast_shapes(*(x.shape[:-1] for x in arrays))
        return [jnp.broadcast_to(x, (*batch, x.shape[-1])) for x in arrays]

    def _differentiable(self, name: str) -> Any:
        rule = RULES[name]
        wrapped = jax.custom_jvp(lambda *arrays: self._call(name, arrays, rule.inputs)[0])

        def derivative(primals: Any, tangents: Any) -> tuple[Any, Any]:
            moved = {
                key: tangent
                for key, tangent in zip(rule.inputs, tangents, strict=True)
                if not isinstance(tangent, jax.custom_derivatives.SymbolicZero) and tangent.shape[-1]
            }
            total = jnp.zeros((*primals[0].shape[:-1], self.model.nv))
            slopes = self._slopes(name, tuple(moved))(*primals) if moved else ()
            for slope, tangent in zip(slopes, moved.values(), strict=True):
                total = total + jnp.einsum("...ij,...j->...i", slope, tangent)
            return wrapped(*primals), total

        wrapped.defjvp(derivative, symbolic_zeros=True)
        return wrapped

    def _slopes(self, name: str, by: tuple[str, ...]) -> Any:
        """The derivatives (..., nv, size) of a function by some inputs, as a function of all; not differentiated."""
        rule = RULES[name]

        def evaluated(*primals: Any) -> tuple[Any, ...]:
            made: dict[str, dict[str, Any]] = {}
            slopes = []
            for function, output in (rule.derivatives[key] for key in by):
                if function not in made:
                    names = [each for each, _ in self._kernel(function).signature.outputs]
                    made[function] = dict(zip(names, self._call(function, primals, rule.inputs), strict=True))
                slopes.append(made[function][output][..., : self.model.nv, :])
            if "q" in by:
                at = by.index("q")
                slopes[at] = self.coordinates.by_coordinates(primals[0][..., None, :], slopes[at])
            return tuple(slopes)

        def refused(_primals: Any, _tangents: Any) -> Any:
            raise second_derivatives(self.model, name)

        held = jax.custom_jvp(evaluated)
        held.defjvp(refused)
        return held

    def _call(self, function: str, arrays: Any, names: tuple[str, ...]) -> Any:
        """All outputs of a function at unit quaternions; inputs not given, as Baumgarte's gains, are zero."""
        kernel = self._kernel(function)
        given = dict(zip(names, arrays, strict=True))
        given["q"] = self.coordinates.unit(given["q"])
        batch = arrays[0].shape[:-1]
        inputs = [given.get(key, jnp.zeros((*batch, size))) for key, size in kernel.signature.inputs]
        results = [jax.ShapeDtypeStruct((*batch, *shape), jnp.float64) for _, shape in kernel.signature.outputs]
        call = jax.ffi.ffi_call(self._target(function), results, vmap_method="broadcast_all")
        return call(given["par"], *inputs)

    def _kernel(self, function: str) -> CompiledKernel:
        kernel = self.model.kernel(function)
        if not isinstance(kernel, CompiledKernel):
            raise InteropError(
                f"{function} can't be called from XLA",
                "the model runs on the interpreter",
                "custom calls are C",
                "sf.compile(system) with backend 'c'",
            )
        return kernel

    def _target(self, function: str) -> str:
        """The name under which XLA calls a function; registered at the first use."""
        name = f"symofros.{self.model.record.hash}.{function}"
        with _LOCK:
            if name not in _REGISTERED:
                _register(name, self._kernel(function), len(_REGISTERED))
        return name


def _single(function: str, what: str, found: str, remedy: str) -> InteropError:
    return InteropError(
        f"{function}: {what} can't be taken", found, "models compute in doubles, of numbers in doubles", remedy
    )


def _register(name: str, kernel: CompiledKernel, slot: int) -> None:
    library = _library()
    if slot >= library.sym_xla_slots():
        raise InteropError(
            "no slot is left for another function",
            f"{slot} functions of models in this process",
            f"{library.sym_xla_slots()} functions in all",
            "start another process",
        )
    many = kernel.in_lanes()
    ffi_address = [int(_address(pointer)) for pointer in (kernel.model, kernel.function, many.function)]
    library.sym_xla_fill(slot, *(ctypes.c_void_p(x) for x in ffi_address), ctypes.c_size_t(MANY))
    handler = ctypes.cast(library.sym_xla_handler(slot), ctypes.c_void_p)
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(handler), platform="cpu")
    _REGISTERED[name] = kernel


def _address(pointer: Any) -> int:

    return int(NativeMemory().ffi.cast("uintptr_t", pointer))


@cache
def _library() -> ctypes.CDLL:
    """The handlers, compiled once a machine with the headers of the installed jaxlib.

    Raises:
        CompileError: There is no C compiler, or it refused.
    """
    toolchain = find_toolchain(None)
    if toolchain is None:
        raise CompileError(NO_COMPILER)
    interface_text = (Path(jax.ffi.include_dir()) / "xla" / "ffi" / "api" / "c_api.h").read_text(encoding="utf-8")
    source = f"{interface_text}\n{native_text('interop/symofros_xla.c')}"
    library = ctypes.CDLL(str(build_library(source, native_text("model/symofros_model.h"), toolchain)))
    library.sym_xla_handler.restype = ctypes.c_void_p
    return library
