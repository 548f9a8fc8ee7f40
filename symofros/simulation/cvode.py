"""SUNDIALS' CVODE behind the interface of our own methods: variable order, for smooth or stiff motions.

The library is the one that the FMPy wheel carries (the extra `cvode`); the right-hand side is C, so nothing of Python
runs in its loop. FMPy's module is not a documented interface: all that leans on it is in this file.
"""

from __future__ import annotations

import ctypes
from importlib import import_module
from typing import Any

import numpy as np

from symofros.errors import Problem, SymofrosError
from symofros.runtime.kernel import Array
from symofros.simulation import stepper as native
from symofros.simulation.stepper import Stepper

_ADAMS, _BDF = 1, 2
_NORMAL, _ONE_STEP = 1, 2
_STOPPED, _ROOT = 1, 2
# CVODE's words -> ours: too much accuracy or error tests fail; it never converges; the right side fails.
_STATUS = {-2: native.TINY_STEP, -3: native.TINY_STEP, -4: native.NO_CONVERGENCE}


def _sundials() -> Any:
    """FMPy's SUNDIALS: its modules by name.

    Raises:
        SymofrosError: FMPy is not installed, or carries none for this platform.
    """
    names = ("libraries", "sundials_context", "nvector_serial", "sundials_types")
    try:
        return {name: import_module(f"fmpy.sundials.{name}") for name in names}
    except (ImportError, OSError, AttributeError) as error:
        raise SymofrosError(
            Problem(
                "simulation: CVODE is not at hand",
                str(error),
                "it comes with FMPy's wheel",
                "pip install 'symofros[cvode]', or use rodas4 or dop853",
            )
        ) from None


class Cvode:
    """One run by CVODE.

    Args:
        stepper: Binds the model; its own loop stays unused.
        stiff: BDF; otherwise Adams.
    """

    def __init__(self, stepper: Stepper, stiff: bool) -> None:
        parts = _sundials()
        self.stepper, self._parts = stepper, parts
        libraries, types = parts["libraries"], parts["sundials_types"]
        self._lib, self._serial = libraries.sundials_cvode, parts["nvector_serial"]
        self.size = stepper.model.nq + stepper.model.nv
        context = types.SUNContext()
        if parts["sundials_context"].SUNContext_Create(0, ctypes.byref(context)) != 0:
            raise SymofrosError("simulation: SUNDIALS makes no context")
        self._context = context
        self.y = self._serial.N_VNew_Serial(self.size, context)
        create = self._function("CVodeCreate", ctypes.c_void_p, ctypes.c_int, types.SUNContext)
        self._memory = ctypes.c_void_p(create(_BDF if stiff else _ADAMS, context))
        matrix = libraries.sundials_sunmatrixdense.SUNDenseMatrix
        matrix.restype = ctypes.c_void_p
        solver = libraries.sundials_sunlinsoldense.SUNLinSol_Dense
        solver.restype = ctypes.c_void_p
        count = ctypes.c_int64(self.size)
        self._matrix = ctypes.c_void_p(matrix(count, count, context))
        self._solver = ctypes.c_void_p(solver(self.y, self._matrix, context))

    def _function(self, name: str, returns: Any, *arguments: Any) -> Any:
        function = self._lib[name]  # A new object each time: FMPy's own declarations stay as they are.
        function.restype, function.argtypes = returns, arguments
        return function

    def _call(self, name: str, *arguments: Any) -> None:
        function = self._function(name, ctypes.c_int, ctypes.c_void_p, *(type(item) for item in arguments))
        if (status := function(self._memory, *arguments)) < 0:
            raise SymofrosError(f"simulation: SUNDIALS' {name} failed with {status}")

    @property
    def values(self) -> Array:
        """The state (q, v), shared with CVODE."""
        return np.ctypeslib.as_array(self._serial.NV_DATA_S(self.y), shape=(self.size,))

    def start(self, q: Array, v: Array) -> int:
        """Place the run at its first state; returns a status."""
        run, ffi = self.stepper.run, self.stepper.ffi
        status = self.stepper.start(q, v, 1)
        self.stepper.take_records()
        if status != native.GOING:
            return status
        self.values[:] = [*q, *v]
        address = ctypes.c_void_p(int(ffi.cast("uintptr_t", ffi.addressof(self.stepper.native, "sym_flat_slope"))))
        number, pointer = ctypes.c_double, ctypes.c_void_p
        self._call("CVodeInit", address, number(run.t0), ctypes.cast(self.y, pointer))
        self._call("CVodeSetUserData", pointer(int(ffi.cast("uintptr_t", run))))
        self._call("CVodeSStolerances", number(run.rtol), number(run.atol))
        self._call("CVodeSetLinearSolver", self._solver, self._matrix)
        self._call("CVodeSetMaxNumSteps", ctypes.c_long(100_000_000))
        self._call("CVodeSetStopTime", number(run.t_end))
        if run.h > 0:
            self._call("CVodeSetInitStep", number(run.h))
        if run.h_max > 0:
            self._call("CVodeSetMaxStep", number(run.h_max))
        if self.stepper.events:
            roots = ctypes.c_void_p(int(ffi.cast("uintptr_t", ffi.addressof(self.stepper.native, "sym_flat_events"))))
            self._call("CVodeRootInit", ctypes.c_int(len(self.stepper.events)), roots)
            signs = (ctypes.c_int * len(self.stepper.events))(*(event.sign for event in self.stepper.events))
            self._call("CVodeSetRootDirection", ctypes.cast(signs, pointer))
        return self._place(run.t0)

    def _place(self, t: float) -> int:
        """The run's present state becomes CVODE's; returns a status."""
        stepper = self.stepper
        at = stepper.ffi.cast("double *", stepper.ffi.from_buffer(self.values))
        return int(stepper.native.sym_flat_place(stepper.run, t, at))

    def advance(self, t: float | None) -> tuple[int, list[int]]:
        """On to a time, or by one step; to the next event at most. Returns a status, and the events met there."""
        reached = ctypes.c_double()
        step = self._function(
            "CVode",
            ctypes.c_int,
            ctypes.c_void_p,
            ctypes.c_double,
            ctypes.c_void_p,
            ctypes.POINTER(ctypes.c_double),
            ctypes.c_int,
        )
        run = self.stepper.run
        mode = _ONE_STEP if t is None else _NORMAL
        code = step(
            self._memory,
            run.t_end if t is None else t,
            ctypes.cast(self.y, ctypes.c_void_p),
            ctypes.byref(reached),
            mode,
        )
        if code < 0:
            failed = self.stepper.failure is not None
            return (native.CALLBACK if failed else _STATUS.get(code, native.DIVERGED)), []
        status = self._place(reached.value)
        met: list[int] = []
        if code == _ROOT:
            flags = (ctypes.c_int * len(self.stepper.events))()
            self._call("CVodeGetRootInfo", ctypes.cast(flags, ctypes.c_void_p))
            met = [i for i, flag in enumerate(flags) if flag]
        ended = code == _STOPPED or reached.value >= run.t_end
        return status or (native.DONE if ended else native.GOING), met

    def count(self) -> int:
        """Steps so far."""
        steps = ctypes.c_long()
        self._call("CVodeGetNumSteps", ctypes.cast(ctypes.pointer(steps), ctypes.c_void_p))
        return int(steps.value)

    def close(self) -> None:
        """Give CVODE's memory back."""
        free = self._function("CVodeFree", None, ctypes.POINTER(ctypes.c_void_p))
        free(ctypes.byref(self._memory))
        libraries = self._parts["libraries"]
        libraries.sundials_sunlinsoldense.SUNLinSolFree_Dense(self._solver)
        libraries.sundials_sunmatrixdense.SUNMatDestroy_Dense(self._matrix)
        self._serial.N_VDestroy_Serial(self.y)
