"""CasADi: one state by the virtual machine or by compiled C, several by `map`; ours and expressions in its scalars."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

import symofros as sf

from ..mechanics.geometry import Array
from ..timing.contestants.arrays import first_compiler
from ..timing.contestants.programs import build
from ..timing.task import flat
from .record import OURS
from .sides import Environment, Offer, Peer, Side, Subject, plain

_FLAGS = ("-O3", "-march=native", "-std=gnu99", '-DCASADI_SYMBOL_EXPORT=__attribute__((visibility("default")))')


@dataclass(frozen=True)
class _Call:
    """A function of CasADi as it is called.

    Attributes:
        function: The function itself, whatever it is made by: nothing is wrapped around it.
        inputs: Value of each input, by the names of the subject's arrays; others are the same in all states.
    """

    function: Any
    inputs: Sequence[str | Array]


def _called(who: str, calls: Callable[[str], _Call], subject: Subject, function: str, states: int) -> Side:
    """A side that calls a function of CasADi on arrays in place, without conversions."""
    called = calls(function)
    own = called.function
    buffer, trigger = own.map(states).buffer() if states > 1 else own.buffer()
    arguments = dict(zip(("q", "v", "w", "cotangent"), subject.at(function, states), strict=False))
    values = (arguments[x] if isinstance(x, str) else np.tile(x, (states, 1)) for x in called.inputs)
    given = [np.ascontiguousarray(value) for value in values]
    wanted = 1 if function == plain(function) else 3  # Derivatives by parameters are not asked for.
    sparsities = [own.sparsity_out(k) for k in range(wanted)]
    outputs = [np.zeros((states, sparsity.nnz())) for sparsity in sparsities]
    for k, array in enumerate(given):
        buffer.set_arg(k, array.data)
    for k, array in enumerate(outputs):
        buffer.set_res(k, array.data)

    def call() -> object:
        trigger()
        return buffer, given, outputs  # Named here, so that what the trigger reads and writes stays.

    def results() -> Array:
        call()
        dense = [np.zeros((states, *sparsity.shape)) for sparsity in sparsities]
        for full, array, sparsity in zip(dense, outputs, sparsities, strict=True):
            full[:, *sparsity.get_triplet()] = array
        return flat(*dense)

    return Side(who, call, results)


def _ours(subject: Subject) -> Offer:
    dynamics = sf.interop.casadi.Dynamics(subject.system)
    par, unread = np.array(subject.model.parameter_values), np.zeros(subject.model.nv)

    def made(function: str) -> _Call:
        own = dynamics.functions[plain(function)]
        if function.endswith("_derivatives"):
            return _Call(own.jacobian(), ("q", "v", "w", par, unread))
        if function.endswith("_vjp"):
            return _Call(own.reverse(1), ("q", "v", "w", par, unread, "cotangent"))
        return _Call(own, ("q", "v", "w", par))

    return partial(_called, OURS, made, subject)


def expressed(subject: Subject, values: Callable[[Any, Any, Any, Any], Mapping[str, Any]], function: str) -> Any:
    """A function of CasADi by expressions in its scalars, and by CasADi's derivatives of these.

    Args:
        subject: Model.
        values: Symbols q, v, a, tau -> expressions by name of the function.
        function: Name of the function.
    """
    ca: Any = import_module("casadi")
    q, v, w, cotangent = symbols = [ca.SX.sym(name, subject.model.nv) for name in ("q", "v", "w", "c")]
    base = plain(function)
    value = values(q, v, w, w)[base]
    if function == base:
        results = [value]
    elif function.endswith("_derivatives"):
        results = [ca.jacobian(value, x) for x in (q, v, w)]
    else:
        x = ca.vertcat(q, v, w)
        results = ca.vertsplit(ca.jtimes(value, x, cotangent, True), subject.model.nv)
    inputs = symbols if function.endswith("_vjp") else symbols[:3]
    return ca.Function(function, inputs, ca.cse([ca.densify(result) for result in results]))


def _compiled(function: Any) -> Any:
    """The same function by CasADi's C of it."""
    ca: Any = import_module("casadi")
    generator = ca.CodeGenerator(f"{function.name()}.c", {"with_header": False})
    generator.add(function)
    built = build(first_compiler(), {"function.c": str(generator.dump())}, _FLAGS)
    return ca.external(function.name(), str(built.path))


def _written(
    who: str, compiled: bool, values: Callable[[Subject], Callable[..., Mapping[str, Any]]], subject: Subject
) -> Offer:
    expressions = values(subject)

    def made(function: str) -> _Call:
        own = expressed(subject, expressions, function)
        inputs = ("q", "v", "w", *(("cotangent",) if function.endswith("_vjp") else ()))
        return _Call(_compiled(own) if compiled else own, inputs)

    return partial(_called, who, made, subject)


def _adam(subject: Subject) -> Callable[..., Mapping[str, Any]]:
    """Functions of ADAM, its base floating but at rest: M and the bias of the joints, and M solved."""
    ca, adam = import_module("casadi"), import_module("adam.casadi")
    robot = adam.KinDynComputations(subject.urdf(), list(subject.model.names.q), gravity=np.array(subject.gravity))
    base, still = np.eye(4), np.zeros(6)

    def values(q: Any, v: Any, a: Any, tau: Any) -> Mapping[str, Any]:
        mass = ca.SX(robot.mass_matrix(ca.SX(base), q))[6:, 6:]
        bias = ca.SX(robot.bias_force(ca.SX(base), q, ca.SX(still), v))[6:]
        return {"forward_dynamics": ca.solve(mass, tau - bias), "inverse_dynamics": mass @ a + bias}

    return values


def _recursion(subject: Subject) -> Callable[..., Mapping[str, Any]]:
    """Newton-Euler and articulated bodies, as one would write them by hand to have CasADi generate good C."""
    tree = import_module("..adapters.casadi.tree", __package__).CasadiTree(subject.system)
    functions = {name: tree.function(name, 0) for name in ("forward_dynamics", "inverse_dynamics")}

    def values(q: Any, v: Any, a: Any, tau: Any) -> Mapping[str, Any]:
        return {name: function(q, v, a, tau) for name, function in functions.items()}

    return values


def _pinocchio(subject: Subject) -> Callable[..., Mapping[str, Any]]:
    pinocchio, symbolic = import_module("pinocchio"), import_module("pinocchio.casadi")
    model = symbolic.Model(pinocchio.buildModelFromXML(subject.urdf()))
    data = model.createData()

    def values(q: Any, v: Any, a: Any, tau: Any) -> Mapping[str, Any]:
        return {
            "forward_dynamics": symbolic.aba(model, data, q, v, tau),
            "inverse_dynamics": symbolic.rnea(model, data, q, v, a),
        }

    return values


def _peers(name: str, values: Any, module: str, package: str, install: str) -> tuple[Peer, Peer]:
    """One way to write the equations, in CasADi's virtual machine and compiled."""

    def peer(who: str, compiled: bool) -> Peer:
        return Peer(who, module, package, install, partial(_written, who, compiled, values))

    return peer(f"{name}, VM", False), peer(f"{name}, compiled", True)


CASADI = Environment(
    "casadi",
    "CasADi",
    Peer(OURS, "casadi", "casadi", "pip install 'symofros[casadi]'", _ours),
    (
        "forward_dynamics",
        "inverse_dynamics",
        "forward_dynamics_derivatives",
        "inverse_dynamics_derivatives",
        "forward_dynamics_vjp",
    ),
    (
        *_peers("recursion", _recursion, "casadi", "casadi", "pip install 'symofros[casadi]'"),
        *_peers("adam", _adam, "adam.casadi", "adam-robotics", "pip install 'symofros[engine-adam]'"),
        *_peers(
            "Pinocchio",
            _pinocchio,
            "pinocchio.casadi",
            "pin",
            "conda install -c conda-forge pinocchio (PyPI's wheel of it is built without CasADi)",
        ),
    ),
    "Functions are called by CasADi itself on arrays in place, several states by `map`: ours is external, in C; peers "
    "are expressions in its scalars, which its virtual machine (VM) evaluates, or gcc compiles (-O3 -march=native) "
    "from the C that it generates; derivatives are CasADi's of these. `recursion` is Newton-Euler and articulated "
    "bodies as written by hand for CasADi in this harness; adam's base floats: it gives M and the bias, of which the "
    "joints' rows are taken, and M is solved.",
)
