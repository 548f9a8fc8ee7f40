"""What every framework of arrays is given of a model: dynamics, and motions along the manifold."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from symofros.interop.coordinates import Coordinates, Operations
from symofros.interop.rules import InteropError, check_functions
from symofros.runtime.model import Model


class WrappedDynamics(ABC):
    """A model's dynamics in a framework; its arrays are the framework's own.

    Args:
        model: Compiled model.
        operations: Operations of the framework that formulas of the manifold take.

    Raises:
        InteropError: The model has prescribed motions, forces that depend on time or rigid contacts.
        SymofrosError: Its forces have states, which `Model.carried` has among its speeds.
    """

    def __init__(self, model: Model, operations: Operations) -> None:
        check_functions(model.record)
        if model.carried is not model:
            model.record.refuse_states(
                "a function of another framework",
                "Dynamics(model.carried), q with idle coordinates, v with the states at its end",
            )
        self.model = model.with_precision("double")
        self.coordinates = Coordinates(model.record.segments, operations)
        self._sizes = {"q": model.nq, "q0": model.nq, "q1": model.nq, "u": model.nu, "par": model.npar}

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.model,)

    def forward_dynamics(self, q: Any, v: Any, u: Any, par: Any = None) -> Any:
        """Accelerations (..., nv) of arrays q (..., nq), v (..., nv), u (..., nu), par (..., npar)."""
        return self._apply("forward_dynamics", q, v, u, par)

    def inverse_dynamics(self, q: Any, v: Any, a: Any, par: Any = None) -> Any:
        """Efforts M a + h - Q(q, v, 0) (..., nv) of arrays q (..., nq), v and a (..., nv), par (..., npar)."""
        return self._apply("inverse_dynamics", q, v, a, par)

    def coordinate_rates(self, q: Any, v: Any) -> Any:
        """Rates q' = N(q) v (..., nq) of arrays q (..., nq), v (..., nv): v itself but for balls and free joints."""
        return self.coordinates.rates(*self._given("coordinate_rates", q=q, v=v))

    def integrate(self, q: Any, dq: Any) -> Any:
        """Move from q (..., nq) along the manifold by dq (..., nv), a velocity times a time: `Model.integrate`."""
        return self.coordinates.integrate(*self._given("integrate", q=q, dq=dq))

    def difference(self, q0: Any, q1: Any) -> Any:
        """The dq (..., nv) that leads from q0 to q1 (..., nq): `Model.difference`."""
        return self.coordinates.difference(*self._given("difference", q0=q0, q1=q1))

    @abstractmethod
    def _apply(self, name: str, *arrays: Any) -> Any:
        """A differentiable function of arrays, the last of which may be None: default parameters."""

    @abstractmethod
    def _given(self, function: str, **given: Any) -> list[Any]:
        """Arrays of doubles with the same leading dimensions."""

    def _check_shape(self, function: str, label: str, shape: tuple[int, ...]) -> None:
        size = self._sizes.get(label, self.model.nv)
        if not shape or shape[-1] != size:
            what = f"{function}: '{label}' has the wrong shape"
            raise InteropError(what, str(tuple(shape)), f"(..., {size})", "check its size")
