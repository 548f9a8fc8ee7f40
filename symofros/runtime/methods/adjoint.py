"""Vector-Jacobian products and second derivatives of a model's functions."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import NamedTuple

import numpy as np

from symofros.base.functions import FUNCTIONS
from symofros.base.model_function import OutputArray, size_of
from symofros.errors import ShapeError
from symofros.runtime.calls.kernel import Array, Numbers
from symofros.runtime.functions import ArrayLike, Functions


class SecondDerivatives(NamedTuple):
    """Second derivatives of tau (..., nv, nv, nv): entry (i, j, k) is that of tau_i by the j-th, then by the k-th.

    Attributes:
        d2tau_dq2: By q_j, then by q_k, both along the manifold.
        d2tau_dv2: By v_j and v_k.
        d2tau_dqdv: By q_j and v_k.
        d2tau_dadq: By a_j and q_k: the derivatives of the mass matrix.
    """

    d2tau_dq2: Array
    d2tau_dv2: Array
    d2tau_dqdv: Array
    d2tau_dadq: Array


class AdjointFunctions(Functions):
    """Methods of a model that differentiate in reverse, or twice; arguments as in `Model`."""

    def vjp(
        self,
        name: str,
        frame: str = "",
        *,
        par: ArrayLike | None = None,
        out: Mapping[str, Numbers] | None = None,
        **arrays: ArrayLike | None,
    ) -> dict[str, Array]:
        """Vector-Jacobian products of a function: the derivatives of the sum of cotangents times outputs.

        `model.vjp("inverse_dynamics", q=q, v=v, a=a, tau_bar=w)["q"]` is w @ dtau_dq. One reverse sweep gives all of
        them for about three times the operations of the function, whatever the number of inputs and parameters.

        Args:
            name: Function that has such products, as "forward_dynamics"; `NAME_vjp` in the table of functions.
            frame: Frame of a frame function.
            par: Run-time parameters.
            out: Arrays that receive products, by their names in `evaluate`: by_q, by_v, ...
            arrays: Inputs of the function by name, and cotangents, each of the shape of its output: `NAME_bar` of the
                output NAME, of frame functions `NAME_WF_bar`. Cotangents that are left out are zero.

        Returns:
            Derivatives by input: "q" (..., nv) along its manifold, then those of "v", "a", "u", "lam" that the
            function has, and "par" (..., npar).

        Raises:
            UnknownNameError: No such products, or no such frame or input.
            ShapeError: An input is missing or does not fit, or there is no cotangent.
        """
        known = tuple(row.transposes for row in FUNCTIONS.values() if row.transposes)
        if not isinstance(name, str) or name not in known:
            what = "differentiable function"
            raise self._unknown(what, str(name)[:80], known, "vector-Jacobian products are of smooth functions")
        weights = FUNCTIONS[name].cotangents
        if all(arrays.get(group) is None for group in weights):
            raise ShapeError(
                f"model '{self.record.name}': no cotangent for {name}",
                ", ".join(arrays) or "no arrays",
                "one cotangent at least weighs the outputs",
                f"pass {' or '.join(weights)}, of the shape of its output",
            )
        given = dict(arrays)
        signature = self._kernel(f"{name}_vjp", self._frame_or_none(frame), "frames have names").signature
        sizes = dict(signature.inputs)
        for group, output in weights.items():
            given[group] = self._flat(group, arrays.get(group), output, sizes[group])
        results = self.evaluate(f"{name}_vjp", frame, par=par, out=out, **given)
        return {label.removeprefix("by_"): value for (label, _), value in zip(signature.outputs, results, strict=True)}

    def inverse_dynamics_second_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> SecondDerivatives:
        """The second derivatives of `inverse_dynamics`, as Pinocchio's computeRNEASecondOrderDerivatives.

        Those by q are along the manifold: d2tau_dq2 is the change of `inverse_dynamics_derivatives` as q moves, and so
        not symmetric where j and k are turns of one ball or free joint (docs/theory/linear.md, section 6).
        """
        given = {"q": q, "v": v, "a": a, "u": u, "t": t}
        tensors = self._call("inverse_dynamics_second_derivatives", "", given, par)
        return SecondDerivatives(*(tensor.reshape(*tensor.shape[:-1], self.nv, self.nv) for tensor in tensors))

    def inverse_dynamics_hvp(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        tau_bar: ArrayLike,
        dq: ArrayLike,
        dv: ArrayLike,
        da: ArrayLike,
        *,
        u: ArrayLike | None = None,
        par: ArrayLike | None = None,
        t: ArrayLike = 0.0,
    ) -> tuple[Array, Array, Array]:
        """Hessian-vector products of tau_bar . `inverse_dynamics`: its Hessian times (dq, dv, da), by q, v and a.

        Each is (..., nv): the change of the vector-Jacobian products as q moves along dq, v by dv and a by da.
        """
        given = {"q": q, "v": v, "a": a, "u": u, "t": t, "tau_bar": tau_bar, "dq": dq, "dv": dv, "da": da}
        by_q, by_v, by_a = self._call("inverse_dynamics_hvp", "", given, par)
        return by_q, by_v, by_a

    def _flat(self, group: str, values: ArrayLike | None, output: OutputArray, size: int) -> Array:
        """A cotangent of an output, with its entries in one (..., size); zeros where None."""
        if values is None:
            return np.zeros(size)
        array, rank = np.asarray(values), len(output.shape)
        outer, inner = array.shape[: max(0, array.ndim - rank)], array.shape[max(0, array.ndim - rank) :]
        known = {"nq": self.nq, "nv": self.nv, "nu": self.nu, "nc": self.nc, "npar": self.npar}
        fits = len(inner) == rank and prod(inner) == size
        for n, text in zip(inner, output.shape, strict=False):
            # Numbers of links, beams and wrenches are not known here: those dimensions count in the size alone.
            stated = all(word.isdecimal() or word in known for word in text.replace("+", " ").split())
            fits = fits and (not stated or n == size_of(text, known))
        if not fits:
            raise ShapeError(
                f"model '{self.record.name}': {group} has the wrong shape",
                str(array.shape),
                f"a cotangent has the shape of its output, (..., {', '.join(output.shape)}): {size} numbers a state"
                if rank
                else "the output is one number a state",
                "give it as the function returns its output",
            )
        return array.reshape(*outer, size)
