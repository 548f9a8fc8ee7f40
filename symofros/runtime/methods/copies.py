"""Models with other settings, in other processes and in notebooks: compiled code is shared, or found in the cache."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Self

from symofros.base.html import html_table
from symofros.errors import ArgumentError, SymofrosError
from symofros.runtime.calls.kernel import Array, Precision
from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.methods.parameters import ParameterFunctions


class CopyFunctions(ParameterFunctions):
    """Copies of a model, with other settings or in other processes, and how notebooks show it."""

    def with_threads(self, threads: int) -> Self:
        """The same compiled code, large batches of which so many threads share; results do not change by a bit.

        Raises:
            ArgumentError: Not a whole number above 0.
        """
        if not isinstance(threads, int) or threads < 1:
            raise ArgumentError(
                f"model '{self.record.name}': not a number of threads",
                repr(threads)[:80],
                "threads is a whole number, 1 or more",
                "os.cpu_count() at most pays",
            )
        return self._like(threads=threads)

    def with_precision(self, precision: Precision) -> Self:
        """The same model, whose functions take and return arrays of float64 ("double"), or of float32 ("single").

        In single precision they run by vectors of twice as many states, at any size of a batch, and are right to about
        seven digits of the largest term that makes up a result. Functions that a solver finishes (constraints,
        derivatives of forward dynamics), interpreted models and those of `Options(batch="loop")` are evaluated in
        double precision and rounded.
        Parameters stay in double precision, and so do `bind`, exports and what solves or simulates: `sf.simulate`,
        `sf.assemble`, `sf.equilibrium`, `sf.inverse_kinematics`, `sf.state_space` and what is made of it. Only
        `sf.simulate_batch` takes accelerations in the precision of the model, of states in double precision.

        Raises:
            ArgumentError: Neither of them.
        """
        self._check_precision(precision)
        return self if precision == self._precision else self._like(precision=precision)

    def _check_precision(self, precision: Precision) -> None:
        if not isinstance(precision, str) or precision not in ("double", "single"):
            raise ArgumentError(
                f"model '{self.record.name}': no such precision",
                repr(precision)[:80],
                "precision is 'double' or 'single'",
                "numpy.float32 is 'single'",
            )

    def cuda(self, precision: Precision | None = None, *, contract: bool = False) -> CudaModel:
        """The model's functions on a graphics processor, with the present values of its parameters.

        Args:
            precision: Precision of all numbers; that of the model by default.
            contract: Whether products and sums are fused: faster where arithmetic bounds, and rounded otherwise than C.

        Raises:
            ArgumentError: No such precision.
            SymofrosError: The model came without its description.
        """
        if precision is not None:
            self._check_precision(precision)
        if self._device_code is None:
            raise SymofrosError(
                f"model '{self.record.name}': no kernels",
                "a model without its description, as that of a compiled diagram",
                "kernels are generated from a description",
                "compile the system that it is of",
            )
        return CudaModel(self.record, self._par, self._device_code, precision or self._precision, contract)

    def ready(self, wait: bool = True) -> Self:
        """The model with its functions as compiled C, where those of `Options(background=True)` began on tape.

        A model never changes the bits of its results by itself: this one stays on tape, and so does a run of it.

        Args:
            wait: Whether to wait for the compiler to make what was called by now; else the result is this model while
                it works.

        Returns:
            This model, where nothing of it is on tape.

        Raises:
            CompileError: The C compiler failed.
        """
        background = self._background
        if background is None or not background.keys or (not wait and background.is_running):
            return self
        background.wait()
        arguments = (self._par, self._threads, self._precision, self._parameter_check is not None)
        model: Self = _restored(background.origin, *arguments)  # type: ignore[assignment]
        for name, frame in background.keys:
            model.kernel(name, frame)
        return model

    def __copy__(self) -> Self:
        """The same model."""
        return self._like()

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """The same model: nothing of it can be changed."""
        return self._like()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the description, so that another process compiles it, or finds it in the cache.

        Raises:
            SymofrosError: The model came without its description.
        """
        if self._origin is None:
            raise SymofrosError(
                f"model '{self.record.name}': it can't be pickled",
                "a model without its description, as that of a compiled diagram",
                "a model is pickled by its description",
                "pickle the description, and compile it there",
            )
        return _restored, (self._origin, self._par, self._threads, self._precision, self._parameter_check is not None)

    def _repr_html_(self) -> str:
        """Sizes and names, for notebooks."""
        names = self.names
        parameters = [f"{name} = {value:g}" for name, value in self.parameters.items()]
        stated = {
            "coordinates": names.q,
            "speeds": names.v,
            "inputs": names.u,
            "parameters": parameters,
            "frames": names.frames,
            "constraints": names.constraints,
        }
        rows = [(what, len(listed), ", ".join(listed)) for what, listed in stated.items() if listed]
        return html_table(f"Model '{self.record.name}'", ("", "number", "names"), rows)


def _restored(
    origin: Callable[[], CopyFunctions], par: Array, threads: int, precision: Precision, checks: bool
) -> CopyFunctions:
    """A model that was pickled: compiled from its description, with the values that it had."""
    model = origin()._like(par, threads, precision)
    return model if checks else model.with_parameter_checks(False)
