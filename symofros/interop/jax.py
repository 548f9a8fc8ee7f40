"""JAX: forward and inverse dynamics as custom calls of XLA, with exact derivatives.

    jax.config.update("jax_enable_x64", True)
    dynamics = sf.interop.jax.Dynamics(model)
    a = jax.jit(dynamics.forward_dynamics)(q, v, u)      # (..., nv), float64, on the CPU

`jit`, `vmap` (one batch in C), `grad`, `jacfwd`, `jacrev`, `jvp`, `vjp`; XLA calls C without Python in between.
Derivatives are the model's, exact; they are not differentiated again.
"""

from __future__ import annotations

import ctypes
import threading
from functools import cache
from pathlib import Path
from typing import Any

from symofros.errors import CompileError, Problem
from symofros.interop.rules import RULES, InteropError, check_model, framework
from symofros.native import native_text
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import NO_COMPILER, find_toolchain
from symofros.runtime.calls.declarations import interface
from symofros.runtime.calls.library import MANY, CompiledKernel
from symofros.runtime.model import Model

jax = framework("jax", "jax")
jnp = jax.numpy

_LOCK = threading.Lock()
# Registered names with what must stay loaded; a name stands for the same function in all runs.
_REGISTERED: dict[str, CompiledKernel] = {}


class Dynamics:
    """A model's dynamics for JAX.

    Args:
        model: Compiled model, whose speeds are the rates of its coordinates.

    Raises:
        InteropError: The model has quaternions, prescribed motions or forces that depend on time; or it is not
            compiled.
    """

    def __init__(self, model: Model) -> None:
        check_model(model)
        self.model = model
        self._functions = {name: self._differentiable(name) for name in RULES}

    def forward_dynamics(self, q: Any, v: Any, u: Any, par: Any = None) -> Any:
        """Accelerations (..., nv) of arrays q (..., nq), v (..., nv), u (..., nu), par (..., npar)."""
        return self._apply("forward_dynamics", q, v, u, par)

    def inverse_dynamics(self, q: Any, v: Any, a: Any, par: Any = None) -> Any:
        """Efforts M a + h - Q(q, v, 0) (..., nv) of arrays q, v, a (..., nv) and par (..., npar)."""
        return self._apply("inverse_dynamics", q, v, a, par)

    def _apply(self, name: str, *arrays: Any) -> Any:
        if not jax.config.jax_enable_x64:
            raise InteropError(
                Problem(
                    f"{name}: arrays are in single precision",
                    "jax_enable_x64 is off",
                    "models compute in doubles",
                    'jax.config.update("jax_enable_x64", True)',
                )
            )
        *states, par = arrays
        given = [*states, self.model.parameter_values if par is None else par]
        given = [jnp.asarray(x, dtype=jnp.float64) for x in given]
        sizes = {"q": self.model.nq, "u": self.model.nu, "par": self.model.npar}
        for label, x in zip(RULES[name].inputs, given, strict=True):
            size = sizes.get(label, self.model.nv)
            if x.ndim == 0 or x.shape[-1] != size:
                raise InteropError(
                    Problem(f"{name}: '{label}' has the wrong shape", str(x.shape), f"(..., {size})", "check its size")
                )
        batch = jnp.broadcast_shapes(*(x.shape[:-1] for x in given))
        return self._functions[name](*(jnp.broadcast_to(x, (*batch, x.shape[-1])) for x in given))

    def _differentiable(self, name: str) -> Any:
        rule = RULES[name]
        wrapped = jax.custom_jvp(lambda *arrays: self._call(name, arrays, rule.inputs)[0])

        def derivative(primals: Any, tangents: Any) -> tuple[Any, Any]:
            made: dict[str, dict[str, Any]] = {}
            total = jnp.zeros((*primals[0].shape[:-1], self.model.nv))
            for key, tangent in zip(rule.inputs, tangents, strict=True):
                function, output = rule.derivatives[key]
                if isinstance(tangent, jax.custom_derivatives.SymbolicZero) or tangent.shape[-1] == 0:
                    continue
                if function not in made:
                    names = [each for each, _ in self._kernel(function).signature.outputs]
                    made[function] = dict(zip(names, self._call(function, primals, rule.inputs), strict=True))
                slope = made[function][output][..., : self.model.nv, :]
                total = total + jnp.einsum("...ij,...j->...i", slope, tangent)
            return wrapped(*primals), total

        wrapped.defjvp(derivative, symbolic_zeros=True)
        return wrapped

    def _call(self, function: str, arrays: Any, names: tuple[str, ...]) -> Any:
        """All outputs of a function; inputs that are not given, as Baumgarte's gains, are zero."""
        kernel = self._kernel(function)
        given = dict(zip(names, arrays, strict=True))
        batch = arrays[0].shape[:-1]
        inputs = [given.get(key, jnp.zeros((*batch, size))) for key, size in kernel.signature.inputs]
        results = [jax.ShapeDtypeStruct((*batch, *shape), jnp.float64) for _, shape in kernel.signature.outputs]
        call = jax.ffi.ffi_call(self._target(function), results, vmap_method="broadcast_all")
        return call(given["par"], *inputs)

    def _kernel(self, function: str) -> CompiledKernel:
        kernel = self.model.kernel(function)
        if not isinstance(kernel, CompiledKernel):
            raise InteropError(
                Problem(
                    f"{function} can't be called from XLA",
                    "the model runs on the interpreter",
                    "custom calls are C",
                    "sf.compile(system) with backend 'c'",
                )
            )
        return kernel

    def _target(self, function: str) -> str:
        """The name under which XLA calls a function; registered at the first use."""
        name = f"symofros.{self.model.record.hash}.{function}"
        with _LOCK:
            if name not in _REGISTERED:
                _register(name, self._kernel(function), len(_REGISTERED))
        return name


def _register(name: str, kernel: CompiledKernel, slot: int) -> None:
    library = _library()
    if slot >= library.sym_xla_slots():
        raise InteropError(
            Problem(
                "no slot is left for another function",
                f"{slot} functions of models in this process",
                f"{library.sym_xla_slots()} functions in all",
                "start another process",
            )
        )
    many = kernel.in_lanes()
    ffi_address = [int(_address(pointer)) for pointer in (kernel.model, kernel.function, many.function)]
    library.sym_xla_fill(slot, *(ctypes.c_void_p(x) for x in ffi_address), ctypes.c_size_t(MANY))
    handler = ctypes.cast(library.sym_xla_handler(slot), ctypes.c_void_p)
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(handler), platform="cpu")
    _REGISTERED[name] = kernel


def _address(pointer: Any) -> int:

    return int(interface().cast("uintptr_t", pointer))


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
