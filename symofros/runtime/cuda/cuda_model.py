"""The functions of a model on a graphics processor: batches of states, and rollouts."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn, Self

import numpy as np

from symofros.base.arrays import real_array
from symofros.base.functions import FRAME_FUNCTIONS, MODEL_FUNCTIONS
from symofros.errors import ShapeError, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.calls.kernel import Array, BatchOptions, Precision
from symofros.runtime.cuda.arrays import DeviceArray, Placed, Strided, StridedSequence, lies_on_device, placed
from symofros.runtime.cuda.device_code import BLOCK, DeviceCode
from symofros.runtime.cuda.driver import Driver, driver
from symofros.runtime.cuda.nvrtc import KernelUsage, compile_cuda, usage_of
from symofros.runtime.cuda.receivers import receivers, strided_result
from symofros.runtime.cuda.streams import is_captured, refused_in_capture, stream_handle
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.record import ModelRecord

Key = tuple[str, str]


@dataclass(frozen=True)
class _Loaded:
    """The kernels of one function on the device."""

    code: DeviceCode
    module: ctypes.c_void_p
    pre: DeviceArray


class CudaModel:
    """Functions of one mechanism on a graphics processor, each compiled when it is first called.

    Arrays have the shapes of `Model`, (n, size), or (size) for all states. Arrays of the device are read in place, by
    `__cuda_array_interface__` or DLPack (CuPy, PyTorch, JAX); those of the host are copied. States side by side
    (`torch.empty(nq, n).T`) are read at the full speed of the memory. Results are `DeviceArray`s of that layout, which
    other libraries take in place, too. Values of parameters are those of the model.
    Results are those of C where products and sums are not fused (`contract`), in single precision to its rounding. A
    step of a rollout that is too long for its method is not noticed, unlike in `simulate`; nor is bending of beams
    beyond their theory, nor a quaternion of another length than one: among the inputs, or in arrays of the device. As
    of `Model`, functions of a state take its quaternions as they are.

    Args:
        record: Names and sizes.
        par: Values of the run-time parameters.
        make: Generates the kernels of a function.
        precision: Precision of all numbers.
        contract: Whether products and sums are fused.
    """

    def __init__(
        self,
        record: ModelRecord,
        par: Array,
        make: Callable[[Key, Precision], DeviceCode],
        precision: Precision,
        contract: bool,
    ) -> None:
        self.record, self.precision, self.contract = record, precision, contract
        self._par, self._make = par, make
        self._codes: dict[Key, DeviceCode] = {}
        self._loaded: dict[Key, _Loaded] = {}
        self._dtype = BatchOptions(precision=precision).dtype
        self._defaults: dict[str, DeviceArray] = {}

    def __copy__(self) -> Self:
        """The same: nothing of it can be changed."""
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """The same: nothing of it can be changed."""
        return self

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        """Not pickled: its kernels are loaded in this process.

        Raises:
            SymofrosError: Always.
        """
        raise SymofrosError(
            f"model '{self.record.name}': what runs on a graphics processor can't be pickled",
            "a CudaModel",
            "kernels are loaded in one process",
            "pickle the model, and call its cuda() in the other process",
        )

    def code(self, name: str, frame: str = "") -> DeviceCode:
        """Kernels of a function as text, which no processor is needed for.

        Raises:
            UnknownNameError: There is no such function or frame.
            SymofrosError: A solver finishes the function.
        """
        key = (name, self.record.frame_aliases.get(frame, frame))
        if key not in self._codes:
            self._check_names(*key)
            code = self._make(key, self.precision)
            if not code.kernels:
                raise SymofrosError(
                    f"model '{self.record.name}': {name} has no kernel",
                    "a solver finishes it",
                    "kernels are of functions that are formulas alone",
                    "call it on the processor: it runs in the model's threads there",
                )
            self._codes[key] = code
        return self._codes[key]

    def _check_names(self, name: str, frame: str) -> None:
        known = FRAME_FUNCTIONS if frame else MODEL_FUNCTIONS
        for what, given, names in (("function", name, known), ("frame", frame, ("", *self.record.frame_names))):
            if given not in names:
                listed = ", ".join(filter(None, names[:12]))
                what = f"model '{self.record.name}': no {what} '{given:.60}'"
                remedy = did_you_mean(given, names) or "functions of frames are called with their frame, others without"
                raise UnknownNameError(what, given[:60], listed, remedy)

    def usage(self, name: str, frame: str = "", architecture: str = "") -> dict[str, KernelUsage]:
        """Registers and memory of the kernels of a function on an architecture ("sm_90"), this machine's by default.

        Raises:
            CompileError: There is no compiler, or no such architecture.
        """
        return usage_of(self.code(name, frame).text, architecture or driver().architecture, self.contract)

    def evaluate(
        self,
        name: str,
        frame: str = "",
        *,
        out: Mapping[str, Any] | None = None,
        wait: bool = True,
        stream: Any = None,
        **inputs: Any,
    ) -> dict[str, Any]:
        """A function of a batch of states.

        Args:
            name: Name of the function.
            frame: Frame of a function of frames.
            out: Arrays of the device to write into, by name, each (n, ...); what is left out is allocated.
            wait: Whether to return when the results are there. Without it they are ready in the stream, and the arrays
                must be kept until then.
            stream: Stream that the kernels go into: a handle, or an object of PyTorch or CuPy; the default stream if
                left out. It waits for what writes the inputs. A graph that is captured from it takes the call in,
                where all arrays lie on the device, `out` has all outputs, the function was called before and
                `wait=False`.
            inputs: Inputs by name; `t` is 0 and `u` the default inputs where they are left out. Quaternions in arrays
                of the host are taken at unit length, as by `Model`; those on the device must have it.

        Returns:
            Results by name.

        Raises:
            ShapeError: An input is missing or does not fit, or an array of `out` is none that can be written into: it
                lies on the host, or shares memory with another one.
            UnknownNameError: There is no such input or output.
            SymofrosError: There is no graphics processor, or the function has no kernel; or a graph is captured, and
                the call can't become part of it.
        """
        key, device, handle = (name, self.record.frame_aliases.get(frame, frame)), driver(), stream_handle(stream)
        captured = is_captured(device, handle)
        if captured:
            self._check_capture(key, {} if out is None else out, wait, inputs)
        inputs = {group: self._with_unit_quaternions(group, value) for group, value in inputs.items()}
        loaded = self._load(key)
        kernel = loaded.code.kernels[0]
        given = self._placed({size[0]: size[1] for size in kernel.signature.inputs}, inputs, device, handle, captured)
        n = self._states(name, given)
        shapes = {label: (n, *shape) for label, shape in kernel.signature.outputs}
        given_out = {} if out is None else out
        written = receivers(name, shapes, given_out, given, self._dtype, device, handle, captured)
        results: dict[str, Any] = dict(given_out)
        for label, shape in shapes.items():
            if label not in results:
                results[label] = DeviceArray(device, shape, self._dtype)
                written[label] = strided_result(label, placed(label, results[label], self._dtype, device), shape)
        arguments = [_batch(given[group], n) for group, _ in kernel.signature.inputs]
        arguments += [written[label] for label in shapes]
        self._launch(loaded, kernel.symbol, n, arguments, device, handle)
        if wait:
            device.wait(handle)
        for result in results.values():
            if isinstance(result, DeviceArray):
                result.stream = None if wait or captured else handle
        return {label: results[label] for label in shapes}

    def _check_capture(self, key: Key, out: Any, wait: bool, inputs: Mapping[str, Any]) -> None:
        """Refuse a call that allocates, copies or waits while a graph is captured."""
        name = " of ".join(filter(None, key))
        if key not in self._loaded:
            raise refused_in_capture(name, "its first call, which compiles it", "call it once before the capture")
        if wait:
            raise refused_in_capture(name, "wait=True", "pass wait=False")
        signature = self._loaded[key].code.kernels[0].signature
        missing = [label for label, _ in signature.outputs if label not in out]
        if missing:
            remedy = "pass arrays of the device for all outputs in out"
            raise refused_in_capture(name, f"out without {', '.join(missing)}", remedy)
        for group, _ in signature.inputs:
            value = inputs.get(group)
            ready = group in self._defaults if value is None else lies_on_device(group, value)
            if not ready:
                found = f"{group} is left out" if value is None else f"{group} lies on the host"
                raise refused_in_capture(name, found, f"pass an array of the device for {group}")
            if isinstance(value, DeviceArray) and value.stream is not None:
                found = f"{group} is still being written"
                raise refused_in_capture(name, found, "wait for it before the capture")

    def rollout(
        self,
        q: Any,
        v: Any,
        u: Any = None,
        *,
        dt: float,
        steps: int,
        every: int | None = None,
        method: str = "rk4",
        t: Any = 0.0,
        stream: Any = None,
    ) -> tuple[DeviceArray, DeviceArray]:
        """Motions from many states by steps of constant length, inputs held over each step.

        Args:
            q: First configurations (n, nq).
            v: First speeds (n, nv).
            u: Inputs: (nu), (n, nu), or (steps, n, nu); the default inputs where they are left out.
            dt: Step [s].
            steps: Number of steps.
            every: Steps between two records, a divisor of steps; the last state alone by default.
            method: "rk4" or "semi_implicit_euler", as in `simulate`.
            t: First time, for all or (n) [s].
            stream: Stream that the kernel goes into, as of `evaluate`.

        Returns:
            q (records, n, nq) and v (records, n, nv).

        Raises:
            UnknownNameError: There is no such method.
            ShapeError: An input does not fit, steps or the step are none, or a quaternion of q is no rotation.
            SymofrosError: The model has constraints, or there is no graphics processor; or a graph is captured.
        """
        self.record.refuse_actions("CUDA: rollout")
        code = self.code("forward_dynamics")
        if method not in code.rollouts:
            known = tuple(code.rollouts)
            raise UnknownNameError(
                f"CUDA: no rollouts by '{method}'", method, ", ".join(known), did_you_mean(method, known)
            )
        every = steps if every is None else every
        _check_rollout(dt, steps, every)
        q, u = self._with_unit_quaternions("q", q), self._with_unit_quaternions("u", u)
        device, handle = driver(), stream_handle(stream)
        if is_captured(device, handle):
            raise refused_in_capture("a rollout", "its results, which it allocates", "roll out before the capture")
        loaded = self._load(("forward_dynamics", ""))
        sizes = {"q": len(self.record.q_names), "v": len(self.record.v_names), "t": 1}
        given = self._placed(sizes, {"q": q, "v": v, "t": t}, device, handle)
        n = self._states("rollout", given)
        inputs = placed("u", self._default("u", device) if u is None else u, self._dtype, device, handle)
        held = self._held(inputs, steps, n)
        records = steps // every
        results = [DeviceArray(device, (records, n, sizes[x]), self._dtype, batch=1) for x in ("q", "v")]
        sequences = [
            StridedSequence(Strided(x.address, x.strides[2] // x.dtype.itemsize, 1), x.strides[0] // x.dtype.itemsize)
            for x in results
        ]
        scalars = [ctypes.c_longlong(steps), ctypes.c_longlong(every), ctypes.c_double(dt)]
        start = [_batch(given[x], n) for x in ("q", "v", "t")]
        arguments = [*scalars, *start[:2], held, start[2], *sequences]
        self._launch(loaded, loaded.code.rollouts[method], n, arguments, device, handle)
        device.wait(handle)
        return results[0], results[1]

    def _held(self, u: Placed, steps: int, n: int) -> StridedSequence:
        """Inputs of each step: the same for all, or one set a step."""
        nu = len(self.record.u_names)
        if len(u.shape) == 3:
            if u.shape != (steps, n, nu):
                raise _misfit("u", u.shape, f"({nu}), ({n}, {nu}) or ({steps}, {n}, {nu})")
            return StridedSequence(_batch(Placed(u.address, u.shape[1:], u.strides[1:], u.owner), n), u.strides[0])
        self._states("rollout", {"u": self._fitting("u", u, nu)}, n)
        return StridedSequence(_batch(u, n), 0)

    def _load(self, key: Key) -> _Loaded:
        if key not in self._loaded:
            code, device = self.code(*key), driver()
            module = device.load(compile_cuda(code.text, device.architecture, self.contract))
            values = code.prepare(self._par.reshape(1, -1))[0]
            pre = DeviceArray(device, (max(1, len(values)),), self._dtype)
            if len(values):
                pre.write(values)
            self._loaded[key] = _Loaded(code, module, pre)
        return self._loaded[key]

    def _launch(self, loaded: _Loaded, symbol: str, n: int, arguments: list[Any], device: Driver, stream: int) -> None:
        given = [ctypes.c_longlong(n), ctypes.c_void_p(loaded.pre.address), *arguments]
        if n:
            device.launch(device.function(loaded.module, symbol), n, BLOCK, given, stream)

    def _placed(
        self,
        sizes: Mapping[str, int],
        inputs: Mapping[str, Any],
        device: Driver,
        stream: int,
        captured: bool = False,
    ) -> dict[str, Placed]:
        """Inputs on the device, in their shapes: (n, size) or (size); t as (n, 1) or (1)."""
        values = {"u": None, "t": None} | dict(inputs)
        for group in inputs:
            if group not in sizes:
                raise UnknownNameError(
                    f"CUDA: no input '{group}'", group, ", ".join(sizes), did_you_mean(group, tuple(sizes))
                )
        arrays = {}
        for group, size in sizes.items():
            if group not in values:
                raise ShapeError(f"CUDA: no {group}", ", ".join(inputs) or "nothing", ", ".join(sizes), "add it")
            value = self._default(group, device) if group in "ut" and values[group] is None else values[group]
            array = placed(group, value, self._dtype, device, stream, captured)
            if group == "t" and value is not self._defaults.get(group):
                array = Placed(array.address, (*array.shape, 1), (*array.strides, 1), array.owner)
            arrays[group] = self._fitting(group, array, size)
        return arrays

    def _with_unit_quaternions(self, group: str, value: Any) -> Any:
        """An input with its quaternions at unit length, if it lies on the host; what fits no input is judged later."""
        if value is None or group not in self.record.quaternions or lies_on_device(group, value):
            return value
        array = real_array(value)
        if array is None or array.shape[-1:] != (len(self.record.vectors[group]),):
            return value
        return at_unit_length(self.record, group, array)

    def _default(self, group: str, device: Driver) -> DeviceArray:
        """Default values (size) of the inputs u or the time t, copied once, because a copy waits for earlier work."""
        if group not in self._defaults:
            values = np.asarray(self.record.u_default if group == "u" else np.zeros(1), self._dtype)
            self._defaults[group] = DeviceArray(device, values.shape, self._dtype)
            self._defaults[group].write(values)
        return self._defaults[group]

    def _fitting(self, group: str, array: Placed, size: int) -> Placed:
        if len(array.shape) not in (1, 2) or array.shape[-1] != size:
            raise _misfit(group, array.shape, f"(n, {size}), or ({size}) for all states")
        return array

    def _states(self, name: str, arrays: Mapping[str, Placed], n: int | None = None) -> int:
        """The number of states, in which all arrays agree."""
        counts = {array.shape[0] for array in arrays.values() if len(array.shape) == 2} | (
            {n} if n is not None else set()
        )
        if len(counts) > 1:
            shown = ", ".join(f"{group} {array.shape}" for group, array in arrays.items())
            raise _misfit(name, tuple(sorted(counts)), f"one number of states in all of {shown}")
        return counts.pop() if counts else 1


def _check_rollout(dt: float, steps: int, every: int) -> None:
    """Refuse numbers of steps and steps that are none."""
    for name, number in (("steps", steps), ("every", every)):
        if isinstance(number, bool) or not isinstance(number, int | np.integer):
            found = f"{name} = {number!r:.40}"
            raise ShapeError(f"CUDA: {name} is no whole number", found, "steps are counted", "pass an int")
    if steps < 1 or not 1 <= every <= steps or steps % every or not (np.isfinite(dt) and dt > 0.0):
        raise ShapeError(
            "CUDA: no such rollout",
            f"{steps} steps of {dt}, a record every {every}",
            "1 <= every <= steps, every divides steps so that the last record is the end, and a step is positive",
            "leave every out for the last state alone",
        )


def _batch(array: Placed, n: int) -> Strided:
    """An input array as kernels take it: address and strides; the stride between states is zero if all share one."""
    if len(array.shape) == 1 or n == 1:
        return Strided(array.address, array.strides[-1], 0)
    return Strided(array.address, array.strides[1], array.strides[0])


def _misfit(group: str, shape: tuple[int, ...], wanted: str) -> ShapeError:
    return ShapeError(f"CUDA: {group} has the wrong shape", str(shape), f"{group} has shape {wanted}", "reshape it")
