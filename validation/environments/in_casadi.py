"""CasADi: one state by the virtual machine or by compiled C, several by `map`; ours and expressions in its scalars."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

import symofros as sf
from validation.environments.record import OURS
from validation.environments.sides import Environment, Offer, Peer, Side, Subject, plain
from validation.mechanics.geometry import Array
from validation.timing.contestants.arrays import first_compiler
from validation.timing.contestants.programs import build
from validation.timing.task import flat

_FLAGS = ("-O3", "-march=native", "-std=gnu99", '-DCASADI_SYMBOL_EXPORT=__attribute__((visibility("default")))')
# Function of CasADi, by ours.
Functions = Mapping[str, Any]


def _called(who: str, functions: Callable[[str], Any], subject: Subject, function: str, states: int) -> Side | None:
    """A side that calls a function of CasADi on arrays in place, without conversions.

    Args:
        who: Name of the side.
        functions: Function of CasADi by our name of it; dense, or None.
        subject: Model and states.
        function: Name of the function.
        states: States in a call.
    """
    own = functions(function)
    if own is None:
        return None
    buffer, trigger = own.map(states).buffer() if states > 1 else own.buffer()
    given = [np.ascontiguousarray(array) for array in subject.at(function, states)]
    shapes = [own.size_out(k) for k in range(own.n_out())]
    outputs = [np.zeros((states, columns, rows)) for rows, columns in shapes]
    for k, array in enumerate(given):
        buffer.set_arg(k, array.data)
    for k, array in enumerate(outputs):
        buffer.set_res(k, array.data)

    def call() -> object:
        trigger()
        return buffer  # Which holds the memory that the trigger reads.

    def results() -> Array:
        call()
        return flat(*(array.transpose(0, 2, 1) for array in outputs))  # Columns lie one after the other.

    return Side(who, call, results)


def _ours(subject: Subject) -> Offer:
    ca: Any = import_module("casadi")
    dynamics = sf.interop.casadi.Dynamics(subject.system)
    nv, par = subject.model.nv, ca.DM(subject.model.parameter_values)

    def made(function: str) -> Any:
        base = plain(function)
        own = dynamics.functions[base]
        q, v, w, cotangent = symbols = [ca.MX.sym(name, nv) for name in ("q", "v", "w", "c")]
        if function == base:
            return ca.Function(function, symbols[:3], [own(q, v, w, par)])
        if function.endswith("_derivatives"):
            slopes = own.jacobian()(q, v, w, par, ca.DM(nv, 1))[:3]
            return ca.Function(function, symbols[:3], [ca.densify(slope) for slope in slopes])
        gradient = own.reverse(1)(q, v, w, par, ca.DM(nv, 1), cotangent)[:3]
        return ca.Function(function, symbols, list(gradient))

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

    def made(function: str) -> Any:
        own = expressed(subject, expressions, function)
        return _compiled(own) if compiled else own

    return partial(_called, who, made, subject)


def _adam(subject: Subject) -> Callable[..., Mapping[str, Any]]:
    """Its base floats; here it stands still: M and the bias of the joints, and M solved."""
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
    tree = import_module("validation.adapters.casadi.tree").CasadiTree(subject.system)
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
