"""What a model's functions are given: arrays that fit its sizes, numbers by name, frames."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import real_array
from symofros.errors import ShapeError, UnknownNameError, did_you_mean
from symofros.runtime.calls.kernel import Array, Numbers
from symofros.runtime.names import Names as Names
from symofros.runtime.names import stacked
from symofros.runtime.record import ModelRecord

# Numbers of a model: in the order of its names, or by name; what is not named keeps its default.
ArrayLike = npt.ArrayLike | Mapping[str, npt.ArrayLike]
_DOUBLE = np.dtype(np.float64)


class Arguments:
    """The sizes and names of one mechanism, and arguments of its functions as arrays.

    Args:
        record: Sizes, names, defaults.
        par: Values of the run-time parameters (npar), which it keeps.
    """

    def __init__(self, record: ModelRecord, par: Array) -> None:
        self.record = record
        self._par = par
        self._par.flags.writeable = False
        self.names = Names.of(record)

    @property
    def nq(self) -> int:
        """Number of coordinates."""
        return len(self.record.q_names)

    @property
    def nv(self) -> int:
        """Number of speeds."""
        return len(self.record.v_names)

    @property
    def nu(self) -> int:
        """Number of inputs."""
        return len(self.record.u_names)

    @property
    def npar(self) -> int:
        """Number of run-time parameters."""
        return len(self.record.par_names)

    @property
    def nc(self) -> int:
        """Number of constraints."""
        return self.record.nc

    def by_name(self, group: str, values: ArrayLike) -> npt.ArrayLike:
        """An argument as an array: values that are given by name stacked (..., size), others as they are.

        Args:
            group: Name of the argument: q, v, a, u, par, lam.
            values: An array, or name -> number or array (...); what is not named keeps its default.

        Raises:
            UnknownNameError: There is no such name.
            ShapeError: A value is not a number.
        """
        return stacked(self.record, self._par, group, values) if isinstance(values, Mapping) else values

    def _array(self, group: str, values: ArrayLike | None, size: int, dtype: npt.DTypeLike = np.float64) -> Numbers:
        # Arrays as they should be pass at once: what follows takes longer than a small function.
        if type(values) is np.ndarray and values.dtype is _DOUBLE and dtype is np.float64 and group != "t":
            if values.ndim and values.shape[-1] == size:
                return values
        array = real_array(self.by_name(group, values) if isinstance(values, Mapping) else values, dtype)
        if array is None:
            raise ShapeError(
                f"model '{self.record.name}': {group} is not an array of numbers",
                f"{type(values).__name__} {values!r:.60}",
                f"{group} is an array of real numbers of shape (..., {size})",
                self._hint(group) or "convert texts, dates and complex numbers, fill in masked ones before",
            )
        if group == "t":
            return array[..., np.newaxis]
        if array.ndim == 0 or array.shape[-1] != size:
            raise ShapeError(
                f"model '{self.record.name}': {group} has the wrong shape",
                str(array.shape),
                f"{group} has shape (..., {size})",
                self._hint(group) or f"give {size} numbers, or rows of {size} for a batch",
            )
        return array

    def _hint(self, group: str) -> str:
        names: dict[str, Any] = {"q": self.names.q, "v": self.names.v, "a": self.names.v, "u": self.names.u}
        names |= {"dq": self.names.v, "par": self.names.par}
        shown = names.get(group, ())
        listed = ", ".join(shown[:8]) + (", …" if len(shown) > 8 else "")
        return f"its last dimension runs over {listed}" if shown else ""

    def _batch_shape(
        self, name: str, shapes: list[tuple[int, ...]], given: Mapping[str, ArrayLike | None]
    ) -> tuple[int, ...]:
        own = {shape for shape in shapes if shape}
        if len(own) <= 1:  # NumPy's answer takes as long as a small function.
            return own.pop() if own else ()
        try:
            return np.broadcast_shapes(*shapes)
        except ValueError:
            stated = {group: self.by_name(group, x) for group, x in given.items() if x is not None}
            shown = ", ".join(f"{group} {np.shape(x)}" for group, x in stated.items())
            raise ShapeError(
                f"{name}: batch dimensions do not broadcast",
                shown,
                "all but the last dimension of each array broadcast together",
                "give each array the same leading dimensions, or none",
            ) from None

    def _frame(self, frame: str) -> str:
        if isinstance(frame, str):
            if frame in self.record.frame_names:
                return frame
            if frame in self.record.frame_aliases:
                return self.record.frame_aliases[frame]
        raise self._unknown("frame", frame, self.record.frame_names, "frames are listed in model.names.frames")

    def _frame_or_none(self, frame: str) -> str:
        """A frame by its name; "" stands for the whole model."""
        return "" if isinstance(frame, str) and not frame else self._frame(frame)

    def _unknown(self, kind: str, name: str, known: tuple[str, ...], rule: str) -> UnknownNameError:
        listed = f"{len(known)} {kind}s" + (": " + ", ".join(known[:12]) if known else "")
        what = f"model '{self.record.name}': no {kind} '{str(name)[:80]}'"
        return UnknownNameError(what, listed, rule, did_you_mean(name, known) or "use another model")
