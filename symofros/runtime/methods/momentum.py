"""Momentum of a model about its mass centre, the parts of its bias, and its mass matrix by entries."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import ArrayLike, Functions


class MomentumFunctions(Functions):
    """Methods of a model that tell of its momentum and bias; arguments as in `Model`.

    All that joints carry counts, beams and rotors included; what is fixed to the world does not.
    """

    def center_of_mass(self, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None) -> Array:
        """Position p_WScm of the mass centre in the world (..., 3) [m].

        Raises:
            DescriptionError: Nothing that joints carry has a mass.
        """
        return self._one("center_of_mass", {"q": q, "u": u}, par)

    def centroidal_momentum(
        self, q: ArrayLike, v: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """Momentum about the mass centre, in world axes (..., 6): linear [kg m/s], then angular [kg m^2/s].

        Along runs by `variational`, which keeps linear momentum and angular momentum about the world's origin to
        rounding, the angular momentum about a mass centre that translates drifts as dt^2 t
        (docs/theory/simulation.md, section 5).
        """
        return self._one("centroidal_momentum", {"q": q, "v": v, "u": u}, par)

    def centroidal_momentum_matrix(
        self, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """A (..., 6, nv) with `centroidal_momentum` = A v: Pinocchio's `data.Ag`."""
        return self._one("centroidal_momentum_matrix", {"q": q, "u": u}, par)

    def centroidal_momentum_rate(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """Rate of `centroidal_momentum` at v' = a (..., 6) [N, N m]: all external forces together, with the weight."""
        return self._one("centroidal_momentum_rate", {"q": q, "v": v, "a": a, "u": u}, par)

    def coriolis_matrix(
        self, q: ArrayLike, v: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None
    ) -> Array:
        """C (..., nv, nv) with C v the Coriolis and centrifugal terms of `bias`, and dM/dt = C + C^T.

        Christoffel's form: dM/dt - 2 C is skew-symmetric, as passivity-based control asks. Prescribed motions count as
        at rest (docs/theory/rigid.md, section 13).
        """
        return self._one("coriolis_matrix", {"q": q, "v": v, "u": u}, par)

    def gravity_force(self, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None) -> Array:
        """Bias at rest g(q) = h(q, 0) (..., nv): the efforts that hold the weight; springs and inputs do not count.

        Not named `gravity`, which is the acceleration that a `System` states.
        """
        return self._one("gravity_force", {"q": q, "u": u}, par)

    def mass_matrix_values(self, q: ArrayLike, *, u: ArrayLike | None = None, par: ArrayLike | None = None) -> Array:
        """Entries of the lower triangle of M(q) that may differ from zero (..., nz), where `mass_matrix_pattern` says.

        `scipy.sparse.coo_array((values, model.mass_matrix_pattern()))` is that triangle; M is symmetric.
        """
        return self._one("mass_matrix_values", {"q": q, "u": u}, par)

    def mass_matrix_pattern(self) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """Rows (nz) and columns (nz) of `mass_matrix_values`, row by row: speeds of which one carries the other.

        Entries that are zero in every state are left out, as those of speeds on different branches.
        """
        row, column = self._call("mass_matrix_pattern", "", {}, None)
        return row.astype(np.intp), column.astype(np.intp)
