"""What frameworks differentiate: functions of models, and which functions give their exact derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from symofros.errors import SymofrosError
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord


class Rule(NamedTuple):
    """A function with its derivatives.

    Attributes:
        inputs: Names of what it is differentiated by, in order.
        derivatives: Function and output that give the derivative by each input; of the rows the first nv count.
    """

    inputs: tuple[str, ...]
    derivatives: Mapping[str, tuple[str, str]]


RULES: dict[str, Rule] = {
    "forward_dynamics": Rule(
        ("q", "v", "u", "par"),
        {
            "q": ("forward_dynamics_derivatives", "by_q"),
            "v": ("forward_dynamics_derivatives", "by_v"),
            "u": ("forward_dynamics_derivatives", "by_u"),
            "par": ("forward_dynamics_by_par", "by_par"),
        },
    ),
    "inverse_dynamics": Rule(
        ("q", "v", "a", "par"),
        {
            "q": ("inverse_dynamics_derivatives", "dtau_dq"),
            "v": ("inverse_dynamics_derivatives", "dtau_dv"),
            "a": ("mass_matrix", "M"),
            "par": ("inverse_dynamics_by_par", "dtau_dpar"),
        },
    ),
}


class InteropError(SymofrosError):
    """A model, or an array, that a framework's wrapper can't take."""


def second_derivatives(model: Model, function: str) -> InteropError:
    """Error for a derivative that a framework differentiates again."""
    product = " or model.inverse_dynamics_hvp(...)" if function == "inverse_dynamics" else ""
    return InteropError(
        f"{function} of model '{model.record.name}': second derivatives are not available here",
        "a derivative is differentiated again",
        "frameworks are given exact first derivatives",
        f"take a method of first order, such as Gauss-Newton, model.evaluate('{function}_hessian', ...){product}; "
        "symofros.interop.casadi has Hessians",
    )


def framework(name: str, extra: str) -> Any:
    """A package, or an error that says how to install it.

    Raises:
        InteropError: It is not installed.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise InteropError.of_extra(
            f"symofros.interop.{extra} needs the package '{name}'",
            "it is not installed",
            "each framework is an extra",
            extra,
        ) from None


def check_model(model: Model) -> None:
    """Refuse models whose functions take more than the arrays that a framework holds.

    Raises:
        InteropError: A motion is prescribed, or forces depend on time.
    """
    check_record(model.record)


def check_record(record: ModelRecord) -> None:
    """The same of a model's names and sizes, before it is compiled."""
    what = f"model '{record.name}' is not offered to other frameworks"
    if record.driven:
        names = ", ".join(record.u_names[-record.driven :])
        raise InteropError(
            what,
            f"inputs that prescribe motion: {names}",
            "inputs are forces",
            "replace the prescribed joint by one with an input",
        )
    if record.timed:
        raise InteropError(what, "formulas depend on the time t", "wrapped functions take no time", "make t an input")


def check_functions(record: ModelRecord) -> None:
    """Refuse models whose accelerations are no function of q, v and u, which steps of C make of them nevertheless.

    Raises:
        InteropError: As of `check_record`; or contacts are rigid, or friction sticks.
    """
    check_record(record)
    kinds = (
        (
            "rigid contacts",
            record.rigid_contacts,
            "push in runs alone, which choose their modes",
            "state their stiffness",
        ),
        ("friction that sticks", record.sticking, "holds in runs alone, which choose its modes", "sticks=False"),
    )
    for kind, found, rule, remedy in kinds:
        if found:
            what = f"functions of model '{record.name}' are not offered to other frameworks"
            names = ", ".join(one.name for one in found)
            remedy = f"{remedy}, or step by sf.Steppers, sf.interop.gymnasium"
            raise InteropError(what, f"{kind}: {names}", f"{kind} {rule}", remedy)


def outputs(model: Model, function: str, given: Mapping[str, Any]) -> dict[str, np.ndarray[Any, Any]]:
    """Outputs of a function by name, from arrays (..., size) by name; of derivatives the rows of the speeds."""
    kernel = model.kernel(function)
    wanted = {name: given[name] for name, _ in kernel.signature.inputs if name in given}
    names = [name for name, _ in kernel.signature.outputs]
    return dict(zip(names, model.evaluate(function, par=given.get("par"), **wanted), strict=True))
