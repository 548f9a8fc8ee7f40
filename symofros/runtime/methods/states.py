"""States of forces: how functions are given them, and the model that carries them as speeds."""

from __future__ import annotations

import warnings
from typing import Self

import numpy as np

from symofros.errors import InconsistentModelWarning
from symofros.runtime.calls.kernel import Array, Numbers
from symofros.runtime.functions import ArrayLike, Functions


class StateFunctions(Functions):
    """Methods of a model about the states of its forces; arguments as in `Model`."""

    @property
    def nz(self) -> int:
        """Number of states of forces."""
        return len(self.record.state_names)

    @property
    def carried(self) -> Self:
        """The model whose speeds end with the states of forces, each beside an idle coordinate, its integral.

        It is the form in which they are integrated, exported and differentiated (docs/theory/states.md, section 1):
        q = (q, integral of z), v = (v, z), M = diag(M, 1), Q = (Q, z'). Of a model without states it is the model.
        """
        return self

    def states_of(self, v: Array) -> Array:
        """The states (..., nz) among the speeds (..., nv + nz) of `carried`."""
        return v[..., v.shape[-1] - self.nz :] if self.nz else v[..., :0]

    def _with_states(self, v: ArrayLike, z: ArrayLike) -> Numbers:
        """Speeds of `carried` (..., nv + nz) where the states are z; v of either length."""
        states, n = self._array("z", z, self.nz), self.carried.nv - self.nz
        speeds = np.asarray(self.by_name("v", v), dtype=np.float64)
        if speeds.ndim == 0 or speeds.shape[-1] not in (n, n + self.nz):
            speeds = self._array("v", v, self.nv)  # Says what is wrong.
        shape = np.broadcast_shapes(speeds.shape[:-1], states.shape[:-1])
        parts = np.broadcast_to(speeds[..., :n], (*shape, n)), np.broadcast_to(states, (*shape, self.nz))
        return np.concatenate(parts, axis=-1) if self.nz else speeds

    def _warn_of_smooth_friction(self, v: ArrayLike, par: ArrayLike | None) -> None:
        """Say what a function takes for friction that sticks, of joints at rest without a mode."""
        values = self._par if par is None else self.checked_parameters(par)
        for note in self.record.smooth_friction_notes(
            np.asarray(self.by_name("v", v), dtype=np.float64), np.asarray(values)
        ):
            warnings.warn(note, InconsistentModelWarning, stacklevel=3)

    def _at_states(self, z: ArrayLike | None) -> Array:
        """Speeds of `carried` at rest (..., nv + nz) where the states are z."""
        rest = np.zeros(self.carried.nv)
        return rest if z is None else self._with_states(rest, z)

    def state_rates(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike,
        *,
        z: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> Array:
        """Rates z' of the states of forces (..., nz)."""
        given = {"q": q, "v": v if z is None else self._with_states(v, z), "u": u, "t": t}
        joined = {group: self._joined(group, values) for group, values in given.items()}
        joined["gains"] = np.zeros(2 * self.nc)
        rates: Array = self.carried._call("forward_dynamics", "", joined, par)[0]
        return self.states_of(rates)

    def carry(
        self, q: ArrayLike | None, v: ArrayLike | None, z: ArrayLike | None
    ) -> tuple[ArrayLike | None, ArrayLike | None]:
        """Configuration (..., nq) and speeds (..., nv) of this model as those of `carried`; None stays that."""
        return q, v if z is None else self._with_states(np.zeros(self.carried.nv) if v is None else v, z)

    def _joined(self, group: str, values: ArrayLike | None) -> ArrayLike | None:
        """An input of `carried`, from this model's."""
        return values
