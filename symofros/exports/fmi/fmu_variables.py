"""The variables of an FMU, in the order of their value references: symofros_fmu.h counts the same way."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from symofros.exports.material import Material
from symofros.mechanics.topology import coordinate_names

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")
_UNQUOTED = re.compile(r"[^A-Za-z0-9_!#$%&()*+,\-./:;<>=@\[\]^{}|~ ]")


@dataclass(frozen=True)
class Variable:
    """One scalar variable.

    Attributes:
        reference: Value reference.
        name: Name by FMI's structured naming.
        causality: Causality as FMI defines it.
        initial: Initial attribute of FMI; "" where it must not be stated.
        start: Start value; None where there is none.
        unit: "" for none.
        derivative: Reference of the state that it is the derivative of.
        depends: References that it depends on; None for all states and inputs. Only of outputs and derivatives.
        about: Description for people.
    """

    reference: int
    name: str
    causality: str
    variability: str
    initial: str = ""
    start: float | None = None
    unit: str = ""
    derivative: int | None = None
    depends: tuple[int, ...] | None = None
    about: str = ""


def quoted(name: str) -> str:
    """A name as one part of a structured name."""
    if _PLAIN.fullmatch(name):
        return name
    return "'" + _UNQUOTED.sub("_", name) + "'"


def variables(material: Material) -> list[Variable]:
    """All of them."""
    listed: list[Variable] = []
    for variable in _variables(material):
        assert variable.reference == len(listed)
        listed.append(variable)
    return _distinct(listed)


def _variables(material: Material) -> Iterator[Variable]:
    record = material.record
    nq, nv, nu = len(record.q_names), len(record.v_names), len(record.u_names)
    at_q, at_v = 1, 1 + nq
    at_u = at_v + nv + nq + nv
    units = _units(material)
    # A loop's start is brought onto the constraints, so it is a guess.
    initial = "approx" if record.nc else "exact"
    yield Variable(0, "time", "independent", "continuous", unit="s")
    for i, name in enumerate(record.q_names):
        yield Variable(
            at_q + i,
            f"q.{quoted(name)}",
            "output",
            "continuous",
            initial,
            material.q_start[i],
            units.get(name, ""),
            depends=(at_q + i,),
        )
    for i, name in enumerate(record.v_names):
        yield Variable(
            at_v + i,
            f"v.{quoted(name)}",
            "output",
            "continuous",
            initial,
            material.v_start[i],
            _per(units.get(name, ""), "s"),
            depends=(at_v + i,),
        )
    rates = _rate_dependencies(material, at_q, at_v)
    for i, name in enumerate(record.q_names):
        yield Variable(
            at_v + nv + i,
            f"der(q.{quoted(name)})",
            "local",
            "continuous",
            "calculated",
            unit=_per(units.get(name, ""), "s"),
            derivative=at_q + i,
            depends=rates[i],
        )
    for i, name in enumerate(record.v_names):
        yield Variable(
            at_v + nv + nq + i,
            f"der(v.{quoted(name)})",
            "local",
            "continuous",
            "calculated",
            unit=_per(units.get(name, ""), "s2"),
            derivative=at_v + i,
        )
    for i, name in enumerate(record.u_names):
        yield Variable(
            at_u + i,
            f"u.{quoted(name)}",
            "input",
            "continuous",
            "",
            record.u_default[i],
            _effort(units.get(name, "")) if i < nu - record.driven else "",
        )
    reference = at_u + nu
    stated = {parameter.name: parameter for parameter in material.system.parameters}
    for i, name in enumerate(record.par_names):
        unit, about = (stated[name].unit, stated[name].description) if name in stated else ("", "")
        yield Variable(
            reference + i,
            f"par.{quoted(name)}",
            "parameter",
            "tunable",
            "exact",
            record.par_default[i],
            unit,
            about=about,
        )
    reference += len(record.par_names)
    for i, name in enumerate(record.constraint_names):
        yield Variable(reference + i, f"lam.{quoted(name)}", "local", "continuous", "calculated")
    reference += record.nc
    for i, kind in enumerate(("kinetic", "potential")):
        yield Variable(reference + i, f"energy.{kind}", "local", "continuous", "calculated", unit="J")
    reference += 2
    prescribed = tuple(range(at_u + nu - record.driven, at_u + nu))
    for frame in material.outputs:
        for i, axis in enumerate("xyz"):
            yield Variable(
                reference + i,
                f"p.{quoted(frame)}.{axis}",
                "output",
                "continuous",
                "calculated",
                unit="m",
                depends=_moved_by(material, frame, i, at_q) + prescribed,
            )
        reference += 3


def _distinct(variables: list[Variable]) -> list[Variable]:
    """Names that replaced characters made equal get a number."""
    seen: dict[str, int] = {}
    for i, variable in enumerate(variables):
        count = seen.get(variable.name, 0)
        seen[variable.name] = count + 1
        if count:
            head, _, tail = variable.name.rpartition("'")
            variables[i] = Variable(**{**variable.__dict__, "name": f"{head} {count}'{tail}"})
    return variables


def _units(material: Material) -> dict[str, str]:
    """Coordinate -> its unit, where the joint's kind states it."""
    return {
        name: coordinate.unit
        for body in material.system.bodies
        if body.joint is not None and not body.joint.traits.user_defined
        for name, coordinate in zip(coordinate_names(body.joint), body.joint.traits.coordinates, strict=True)
    }


def _per(unit: str, time: str) -> str:
    return f"{unit}/{time}" if unit else ""


def _effort(unit: str) -> str:
    return {"rad": "N.m", "m": "N"}.get(unit, "")


def _rate_dependencies(material: Material, at_q: int, at_v: int) -> dict[int, tuple[int, ...]]:
    """Coordinate -> what q' = N v reads."""
    dependencies: dict[int, tuple[int, ...]] = {}
    for s in material.record.segments:
        if s.kind == "linear":
            dependencies |= {s.q + i: (at_v + s.v + i,) for i in range(s.size)}
            continue
        quaternion = range(at_q + s.q + s.translations, at_q + s.q + s.size)
        dependencies |= {s.q + i: (*quaternion, *range(at_v + s.v, at_v + s.v + s.speeds)) for i in range(s.size)}
    return dependencies


def _moved_by(material: Material, frame: str, row: int, at_q: int) -> tuple[int, ...]:
    """The coordinates that move a frame along an axis: columns of its Jacobian that are not zero at random points."""
    nv = len(material.record.v_names)
    first = material.functions.index(("frame_jacobian", frame)) * material.points
    rows = [check.outputs[row * nv : (row + 1) * nv] for check in material.checks[first : first + material.points]]
    moving = {i for values in rows for i, value in enumerate(values) if value != 0.0}
    moved: list[int] = []
    for s in material.record.segments:
        if s.kind == "linear":
            moved += [at_q + s.q + i for i in range(s.size) if s.v + i in moving]
        elif moving & set(range(s.v, s.v + s.speeds)):
            moved += range(at_q + s.q, at_q + s.q + s.size)
    return tuple(moved)
