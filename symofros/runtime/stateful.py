"""A model whose forces have states of their own, as it is called: v and z apart, no idle coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from symofros.base.functions import FUNCTIONS, INPUTS
from symofros.errors import SymofrosError
from symofros.runtime.beams import ElasticBeam
from symofros.runtime.calls.kernel import Array, Kernel, Numbers, Precision
from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.functions import ArrayLike, Key
from symofros.runtime.methods.linear import Output, StateMatrices
from symofros.runtime.methods.routes import Routes
from symofros.runtime.model import Model


class StatefulModel(Model):
    """A model whose forces have states: its functions are those of `carried`, cut to (q, v) and z.

    Args:
        carried: Model whose speeds end with the states.
    """

    def __init__(self, carried: Model) -> None:
        super().__init__(
            carried.record.without_states(),
            None,
            par=carried.parameter_values,
            threads=carried.threads,
            precision=carried.precision,
            parameter_check=carried._parameter_check,
            origin=carried._origin,
        )
        self._carried = carried

    @property
    def carried(self) -> Model:  # type: ignore[override]
        """The model whose speeds end with the states of forces."""
        return self._carried

    def _like(self, par: Array | None = None, threads: int | None = None, precision: Precision | None = None) -> Self:
        return type(self)(self._carried._like(par, threads, precision))

    def with_parameter_checks(self, checks: bool) -> Self:
        """The same as in `Model`."""
        return type(self)(self._carried.with_parameter_checks(checks))

    def ready(self, wait: bool = True) -> Self:
        """The same as in `Model`."""
        ready = self._carried.ready(wait)
        return self if ready is self._carried else type(self)(ready)

    def prepare(self, *names: str) -> None:
        """The same as in `Model`."""
        self._carried.prepare(*names)

    def has(self, name: str) -> bool:
        """The same as in `Model`."""
        return self._carried.has(name)

    @property
    def routes(self) -> Routes:
        """The same as in `Model`."""
        return self._carried.routes

    def beams(self, par: ArrayLike | None = None) -> tuple[ElasticBeam, ...]:
        """The same as in `Model`."""
        return self._carried.beams(par)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the carried model."""
        return stated, (self._carried,)

    # Calls.

    def _one(self, name: str, given: Mapping[str, ArrayLike | None], par: ArrayLike | None) -> Numbers:
        return self._call(name, "", given, par)[0]

    def _call(
        self,
        name: str,
        frame: str,
        given: Mapping[str, ArrayLike | None],
        par: ArrayLike | None,
        out: Mapping[str, Numbers] | None = None,
    ) -> list[Numbers]:
        joined = {group: self._joined(group, values) for group, values in given.items()}
        outputs = self._carried._call(name, frame, joined, par, out)
        return [
            self._cut(name, output, array.shape)
            for output, array in zip(outputs, FUNCTIONS[name].outputs, strict=False)
        ]

    def _joined(self, group: str, values: ArrayLike | None) -> ArrayLike | None:
        """An input of the carried model: with zeros for the states where they are not there."""
        size = INPUTS[group][0]
        if values is None or size not in ("nq", "nv"):
            return values
        n = {"nq": self.nq, "nv": self.nv}[size]
        array = np.asarray(self.by_name(group, values))
        if group == "v" and array.ndim and array.shape[-1] == self._carried.nv:
            return array
        array = self._array(group, array, n)
        return np.concatenate([array, np.zeros((*array.shape[:-1], self.nz))], axis=-1)

    def _cut(self, name: str, output: Numbers, shape: Sequence[str]) -> Numbers:
        """An output without the rows and columns of states."""
        for axis, text in enumerate(shape, output.ndim - len(shape)):
            total = output.shape[axis]
            kept = self._carried.record.own_entries(text, total)
            if len(kept) < total:
                output = np.take(output, kept, axis=axis)
        return output

    def carry(
        self, q: ArrayLike | None, v: ArrayLike | None, z: ArrayLike | None
    ) -> tuple[ArrayLike | None, ArrayLike | None]:
        """The same as in `Model`."""
        speeds = None if v is None else self._joined("v", v)
        return None if q is None else self._joined("q", q), speeds if z is None else super().carry(None, speeds, z)[1]

    # What has no states: refused, or taken apart.

    def _refusal(self, rule: str) -> SymofrosError:
        return SymofrosError(
            f"model '{self.record.name}' has states of forces: this takes none",
            ", ".join(self.record.state_names[:8]),
            rule,
            "model.carried has them among its speeds",
        )

    def _kernel(self, name: str, frame: str, rule: str) -> Kernel:
        raise self._refusal("kernels and functions by name are of coordinates and speeds alone")

    def _unit_of(self, name: str, frame: str) -> tuple[Key, ...]:
        raise self._refusal("kernels are of coordinates and speeds alone")

    def formulas(self, formulas: Sequence[Any], derivatives: bool = True, reactions: bool = False) -> Kernel:
        """Refused: kernels are of `carried`."""
        raise self._refusal("kernels of formulas are of coordinates and speeds alone")

    def cuda(self, precision: Precision | None = None, *, contract: bool = False) -> CudaModel:
        """Refused: kernels are of `carried`."""
        raise self._refusal("kernels are of coordinates and speeds alone")

    def linearize(  # type: ignore[override]
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        outputs: Sequence[Output] | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
        z: ArrayLike | None = None,
    ) -> tuple[Array, Array] | StateMatrices:
        """A (..., 2 nv + nz, 2 nv + nz) and B (..., 2 nv + nz, nu) of small changes of (q, v, z); as of `Model`.

        Among outputs "z" are the states (nz rows).
        """
        carried, n = self._carried, self._carried.nv
        coordinates, speeds = self._joined("q", q), self._joined("v", v) if z is None else self._with_states(v, z)
        assert coordinates is not None and speeds is not None
        kept = np.r_[0 : self.nv, n : 2 * n]
        stated = ["v" if output == "z" else output for output in outputs or ()]
        A, B, C, D = carried.linearize(coordinates, speeds, u, outputs=stated, par=par, t=t)
        A, B = A[..., kept, :][..., kept], B[..., kept, :]
        if outputs is None:
            return A, B
        rows, first = list[int](), 0
        for output in outputs:
            own = {"z": range(self.nv, n), "lam": range(self.nc)}.get(
                str(output), range(6 if isinstance(output, tuple) else self.nv)
            )
            rows += [first + row for row in own]
            first += len(own) if isinstance(output, tuple) or output == "lam" else n
        return StateMatrices(A, B, C[..., rows, :][..., kept], D[..., rows, :])


def stated(model: Model) -> Model:
    """The model as it is called: with its states apart, where it has some."""
    return StatefulModel(model) if model.record.state_names else model
