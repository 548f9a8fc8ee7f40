"""The variables of an FMU, in the order of their value references.

symofros_fmu.h counts the same way, of diagrams symofros_fmu_program.h.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import accumulate, chain, repeat

from symofros.exports.diagram_interface import Interface, Quantity, entry_starts
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


def diagram_variables(shown: Interface) -> list[Variable]:
    """All variables of an FMU of a diagram, in the order of their references."""
    listed = [Variable(0, "time", "independent", "continuous", unit="s")]
    kinds: tuple[tuple[str, str, tuple[Quantity, ...]], ...] = (
        ("input", "", shown.inputs),
        ("output", "calculated", shown.outputs),
        ("parameter", "exact", shown.parameters),
    )
    references: dict[str, list[int]] = {}
    for causality, initial, quantities in kinds:
        variability = "tunable" if causality == "parameter" else "continuous"
        starts: Iterator[float | None] = chain(entry_starts(quantities), repeat(None))
        for quantity in quantities:
            depends = sorted(at for name in quantity.depends for at in references[name])
            for name, unit, start in zip(quantity.entries, quantity.units, starts, strict=False):
                base, bracket, index = name.partition("[")
                label = ".".join(map(quoted, base.split("."))) + bracket + index.replace("][", ",")
                references.setdefault(quantity.name, []).append(len(listed))
                stated = tuple(depends) if causality == "output" else None
                listed.append(
                    Variable(
                        len(listed), label, causality, variability, initial, start, _plain_unit(unit), depends=stated
                    )
                )
    return _distinct(listed)


def _plain_unit(unit: str) -> str:
    """A unit as FMI's examples write units: "N.m" of "N m", "rad/s2" of "rad/s^2"."""
    return unit.replace(" ", ".").replace("^", "")


@dataclass(frozen=True)
class _Numbering:
    """First references of the groups of variables.

    Attributes:
        q, v, dq, dv, u, par, lam, energy, frames: First reference of coordinates, speeds, their rates, inputs,
            parameters, multipliers, energies, positions of frames.
    """

    q: int
    v: int
    dq: int
    dv: int
    u: int
    par: int
    lam: int
    energy: int
    frames: int

    @classmethod
    def of(cls, material: Material) -> _Numbering:
        record = material.record
        nq, nv = len(record.q_names), len(record.v_names)
        sizes = (1, nq, nv, nq, nv, len(record.u_names), len(record.par_names), record.nc, 2)
        return cls(*accumulate(sizes))


def variables(material: Material) -> list[Variable]:
    """All variables of an FMU, in the order of their references."""
    at, units = _Numbering.of(material), _units(material)
    listed = [Variable(0, "time", "independent", "continuous", unit="s")]
    for group in (_states(material, at, units), _rates(material, at, units), _given(material, at, units)):
        listed += group
    listed += _local(material, at)
    listed += _positions(material, at)
    assert [variable.reference for variable in listed] == list(range(len(listed)))
    return _distinct(listed)


def _states(material: Material, at: _Numbering, units: Mapping[str, str]) -> Iterator[Variable]:
    """Coordinates and speeds."""
    record = material.record
    # A loop's start is brought onto the constraints, so it is a guess.
    initial = "approx" if record.nc else "exact"
    groups = (
        ("q", at.q, record.q_names, material.q_start, lambda unit: unit),
        ("v", at.v, record.v_names, material.v_start, lambda unit: _per(unit, "s")),
    )
    for group, first, names, start, unit_of in groups:
        for i, name in enumerate(names):
            reference, unit = first + i, unit_of(units.get(name, ""))
            label = f"{group}.{quoted(name)}"
            yield Variable(reference, label, "output", "continuous", initial, start[i], unit, depends=(reference,))


def _rates(material: Material, at: _Numbering, units: Mapping[str, str]) -> Iterator[Variable]:
    """Variables of the time derivatives of the coordinates and speeds."""
    rates = _rate_dependencies(material, at.q, at.v)
    groups = (
        ("q", at.dq, at.q, material.record.q_names, "s", rates),
        ("v", at.dv, at.v, material.record.v_names, "s2", dict[int, tuple[int, ...]]()),
    )
    for group, first, state, names, time, depends in groups:
        for i, name in enumerate(names):
            yield Variable(
                first + i,
                f"der({group}.{quoted(name)})",
                "local",
                "continuous",
                "calculated",
                unit=_per(units.get(name, ""), time),
                derivative=state + i,
                depends=depends.get(i),
            )


def _given(material: Material, at: _Numbering, units: Mapping[str, str]) -> Iterator[Variable]:
    """Inputs and parameters."""
    record = material.record
    efforts = len(record.u_names) - record.driven
    for i, name in enumerate(record.u_names):
        unit = _effort(units.get(name, "")) if i < efforts else ""
        yield Variable(at.u + i, f"u.{quoted(name)}", "input", "continuous", "", record.u_default[i], unit)
    stated = {parameter.name: parameter for parameter in material.system.parameters}
    for i, name in enumerate(record.par_names):
        unit, about = (stated[name].unit, stated[name].description) if name in stated else ("", "")
        label, value = f"par.{quoted(name)}", record.par_default[i]
        yield Variable(at.par + i, label, "parameter", "tunable", "exact", value, unit, about=about)


def _local(material: Material, at: _Numbering) -> Iterator[Variable]:
    """Multipliers and energies."""
    for i, name in enumerate(material.record.constraint_names):
        yield Variable(at.lam + i, f"lam.{quoted(name)}", "local", "continuous", "calculated")
    for i, kind in enumerate(("kinetic", "potential")):
        yield Variable(at.energy + i, f"energy.{kind}", "local", "continuous", "calculated", unit="J")


def _positions(material: Material, at: _Numbering) -> Iterator[Variable]:
    """Positions of frames; prescribed motions move them, too."""
    prescribed = tuple(range(at.par - material.record.driven, at.par))
    for k, frame in enumerate(material.outputs):
        for i, axis in enumerate("xyz"):
            yield Variable(
                at.frames + 3 * k + i,
                f"p.{quoted(frame)}.{axis}",
                "output",
                "continuous",
                "calculated",
                unit="m",
                depends=_moved_by(material, frame, i, at.q) + prescribed,
            )


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
    """Index of a coordinate -> references of the variables on which its rate in q' = N v depends."""
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
