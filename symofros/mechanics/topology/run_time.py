"""Run-time parameters judged by the conditions of the description they belong to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial, reduce

import numpy as np

from symofros.base.arrays import Array
from symofros.description.beams.beam import STATION, Beam
from symofros.description.joints.joint import Joint
from symofros.description.system import Body, System
from symofros.description.values import Rotation, Value, symbols
from symofros.errors import Problem
from symofros.mechanics.topology.beams import (
    INTERPOLATION_TOLERANCE,
    QUADRATURE_TOLERANCE,
    beam_conditions,
    beam_number_problems,
    interpolation_error,
    least_stiffness,
    quadrature_error,
)
from symofros.mechanics.topology.conditions import Condition, Conditions
from symofros.mechanics.topology.constraints import constraint_conditions
from symofros.mechanics.topology.forces import contact_conditions, element_conditions
from symofros.mechanics.topology.formulas import Stated, stated_values
from symofros.mechanics.topology.joints import joint_number_problems
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.physics import (
    inertia_conditions,
    massless_tip_conditions,
    moment_conditions,
    rotor_conditions,
)
from symofros.mechanics.topology.switches import switch_conditions


def value_conditions(system: System) -> Iterator[Condition]:
    """Every formula of parameters alone is finite; numbers are so since they were read."""
    for stated in stated_values(system):
        if stated.scope == "parameters" and not isinstance(stated.value, float):
            where = system.origin.get(stated.key, "")
            yield Condition((stated.value,), "any", partial(_not_finite, stated, where))


def _not_finite(stated: Stated, where: str, _: Numbers) -> Problem:
    return Problem(
        f"{stated.what}: not a finite number at the parameters' values",
        f"'{stated.value}'",
        "every formula is finite at the default parameters, and at those of a run",
        "mind divisions by zero and function domains",
        where,
    )


def rotations_of(system: System, body: Body) -> Iterator[tuple[str, Rotation, str]]:
    """Constant rotations of a body: what each is, itself, "file:line"."""
    if body.joint is not None:
        joint = body.joint
        yield f"joint '{joint.name}': rotation", joint.rotation, system.origin.get(("joint", joint.name), "")
    if body.inertia is not None:
        where = system.origin.get(("body", body.name), "")
        yield f"body '{body.name}': inertia rotation", body.inertia.rotation, where
    for frame in body.frames:
        what = f"frame '{frame.name}' of body '{body.name}': rotation"
        yield what, frame.rotation, system.origin.get(("frame", body.name, frame.name), "")


class RunTimeCheck:
    """What run-time parameters must satisfy: every condition of the description that depends on them.

    Args:
        system: A sound system.
        names: Run-time parameters, in the order of their values.
    """

    def __init__(self, system: System, names: tuple[str, ...]) -> None:
        self.system, self.names = system, names

    @cached_property
    def conditions(self) -> Conditions:
        """Conditions that depend on the parameters; they hold at the defaults."""
        system, names = self.system, frozenset(self.names)
        conditions = [*value_conditions(system), *constraint_conditions(system), *element_conditions(system)]
        conditions += [*contact_conditions(system), *switch_conditions(system), *rotor_conditions(system)]
        for beam in system.beams:
            conditions += beam_conditions(beam, system.origin.get(("body", beam.name), ""))
        conditions += [*inertia_conditions(system), *massless_tip_conditions(system), *moment_conditions(system)]
        stated = Conditions(c for c in conditions if c.symbols & names)
        violated = stated.violated(system.parameter_values())[:, 0]
        return Conditions(c for c, broken in zip(stated.conditions, violated, strict=True) if not broken)

    def problems(self, par: Array) -> list[Problem]:
        """Problems of the first invalid set of parameters; [] if all are valid.

        Args:
            par: Sets of parameters (n, npar).
        """
        if not np.all(np.isfinite(par)):
            lane = int(np.argmin(np.isfinite(par).all(axis=1)))
            name = self.names[int(np.argmin(np.isfinite(par[lane])))]
            value = par[lane, self.names.index(name)]
            fault = Problem("not a finite number", str(value), "a parameter is one finite number", "pass a number")
            return [self._of_lane(fault, (name,), par, lane)]
        values: dict[str, Array | float] = dict(self.system.parameter_values())
        values |= {name: par[:, i] for i, name in enumerate(self.names)}
        violated = self.conditions.violated(values, len(par))
        if violated.any():
            lane = int(np.argmax(violated.any(axis=0)))
            numbers, faults = Numbers(self.system, self._at(par, lane)), dict[Problem, list[str]]()
            for condition, broken in zip(self.conditions.conditions, violated[:, lane], strict=True):
                if broken:
                    faults.setdefault(condition.problem(numbers), sorted(condition.symbols))
            return [self._of_lane(problem, names, par, lane) for problem, names in faults.items()]
        return self._section_problems(par, values) or self._sampled_problems(par)

    def _section_problems(self, par: Array, values: Mapping[str, Array | float]) -> list[Problem]:
        """Section properties that parameters have made too abrupt for the quadrature, or without a sign."""
        for beam in self._sections:
            errors = [quadrature_error(beam, value, values) for _, value in beam.along_axis()]
            least, _ = least_stiffness(beam, values)
            right = (reduce(np.maximum, errors) <= QUADRATURE_TOLERANCE) & (least > 0.0)
            wrong = np.flatnonzero(~(right & (interpolation_error(beam, values) <= INTERPOLATION_TOLERANCE)))
            if wrong.size:
                lane = int(wrong[0])
                where = self.system.origin.get(("body", beam.name), "")
                problems = beam_number_problems(beam, Numbers(self.system, self._at(par, lane)), where)
                names = self._names_in(*(value for _, value in beam.along_axis()), beam.length)
                return [self._of_lane(problem, names, par, lane) for problem in problems]
        return []

    def _sampled_problems(self, par: Array) -> list[Problem]:
        """Problems of the first set of parameters with an invalid rotation or axis; their checks have no margin."""
        if not (self._turned or self._axes):
            return []
        _, first = np.unique(par, axis=0, return_index=True)
        for lane in sorted(first.tolist()):
            numbers = Numbers(self.system, self._at(par, lane))
            for names, problems in self._sampled(numbers):
                faults = [self._of_lane(problem, names, par, lane) for problem in problems]
                if faults:
                    return faults
        return []

    def _sampled(self, numbers: Numbers) -> Iterator[tuple[tuple[str, ...], Iterator[Problem]]]:
        where = self.system.origin.get
        for what, rotation, line in self._turned:
            yield self._names_in(*rotation), numbers.rotation_problems(what, rotation, line)
        for joint in self._axes:
            names = self._names_in(*joint.axis, *joint.axis2, *joint.moving_rotation, *joint.moving_position)
            yield names, joint_number_problems(joint, numbers, where(("joint", joint.name), ""))

    @cached_property
    def _turned(self) -> list[tuple[str, Rotation, str]]:
        """Rotations that depend on parameters."""
        rotations = [item for body in self.system.bodies for item in rotations_of(self.system, body)]
        return [item for item in rotations if self._names_in(*item[1])]

    @cached_property
    def _axes(self) -> list[Joint]:
        """Joints whose axes or own motion depend on parameters."""
        joints = [body.joint for body in self.system.bodies if body.joint is not None]
        return [
            joint
            for joint in joints
            if self._names_in(*joint.axis, *joint.axis2, *joint.moving_rotation, *joint.moving_position)
        ]

    @cached_property
    def _sections(self) -> list[Beam]:
        """Beams with section properties that depend on parameters, and change along the beam or are a matrix."""
        beams = self.system.beams
        return [
            beam
            for beam in beams
            if any((beam.stiffness or STATION in symbols(v)) and self._names_in(v) for _, v in beam.along_axis())
        ]

    def _names_in(self, *values: Value) -> tuple[str, ...]:
        """Run-time parameters that values depend on."""
        used = frozenset[str]().union(*map(symbols, values))
        return tuple(name for name in self.names if name in used)

    def _at(self, par: Array, lane: int) -> dict[str, float]:
        return dict(zip(self.names, par[lane].tolist(), strict=True))

    def _of_lane(self, problem: Problem, names: Iterable[str], par: Array, lane: int) -> Problem:
        """A problem with the values that it comes from, and the number of the set where there are several."""
        at = self._at(par, lane)
        shown = ", ".join(f"{name} = {at[name]:g}" for name in names if name in at)
        of_set = f" of set {lane}" if len(par) > 1 else ""
        return replace(problem, what=f"run-time parameters{of_set} ({shown}): {problem.what}")
