"""Events of a motion: formulas whose zeros runs look for, and what happens there."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

from symofros.base.arguments import CheckedCalls, check_fields
from symofros.base.names import coordinate_of, speed_column, speed_of
from symofros.errors import SymofrosError, UnknownNameError, did_you_mean

_SIGNS = {"both": 0, "rising": 1, "falling": -1}


@dataclass(frozen=True)
class Event(metaclass=CheckedCalls):
    """A zero crossing, and what happens there.

    Attributes:
        formula: Formula of coordinates, speeds, inputs, parameters and t: text or SymPy expression. Also of the
            multipliers of constraints ("lam.grasp.x"), their wrenches on the second frame in world axes
            ("wrench.grasp.fx" to ".mz") and the wrenches that joints transmit to their bodies in body axes
            ("reaction.q1.fx").
        direction: Direction of the crossings that count.
        terminal: Whether the first one ends the run.
        name: Its key in the mapping that it stands in.
        action: What happens at each crossing that counts: run-time parameter or speed ("grip", "dq1") -> number, or
            formula of the state before. Then the speeds meet the constraints that hold, by a plastic impact
            (docs/theory/constraints.md, section 13). `simulate`, `simulate_batch`, steppers, packages of C and FMUs do
            them.
        once: Whether only the first crossing counts.
        restitution: Newton's coefficient e, 0 to 1, of an action that lets constraints strike: they hold for the
            instant alone, and what they take of the speeds comes back e times; parameters are then as before. With 0
            the run ends there unless forces part the bodies again, or `rests` is given.
        rests: Force of the constraint that strikes, as a formula that is above zero where the bodies press:
            "lam.floor.z". Where strikes accumulate, and after one without rebound, the contact then persists, and opens
            where the force falls to zero, an event of its own, "NAME opens" (docs/theory/constraints.md, 13).
    """

    formula: Any
    direction: Literal["both", "rising", "falling"] = "both"
    terminal: bool = False
    name: str = ""
    action: Mapping[str, Any] | None = field(default=None, hash=False)
    once: bool = False
    restitution: float | None = None
    rests: Any = None

    def __post_init__(self) -> None:
        """The direction must be known, restitution a share, and have an action."""
        check_fields(self)
        if self.restitution is not None and not (self.action and 0.0 <= self.restitution <= 1.0):
            found = f"restitution = {self.restitution}, action = {self.action!r:.60}"
            rule = "restitution is a number from 0 to 1, of an action that engages what strikes"
            raise SymofrosError("event: no restitution", found, rule, "action={'contact': 1}, restitution=0.8")
        if self.rests is not None:
            self._check_contact()

    def _check_contact(self) -> None:
        """What comes to rest is one contact, that one parameter engages, and has a direction."""
        values = list((self.action or {}).values())
        fits = len(values) == 1 and isinstance(values[0], (int, float)) and values[0] == 1
        if self.restitution is None or self.direction == "both" or self.once or self.terminal or not fits:
            found = f"direction = '{self.direction}', action = {self.action!r:.60}, restitution = {self.restitution}"
            rule = "a contact that rests is engaged by one parameter set to 1, again and again, from one side"
            remedy = "Event('gap', 'falling', action={'contact': 1}, restitution=0.5, rests='lam.floor.z')"
            raise SymofrosError("event: no contact that rests", found, rule, remedy)

    @property
    def sign(self) -> int:
        """1 rising, -1 falling, 0 both."""
        return _SIGNS[self.direction]

    @property
    def coefficient(self) -> float:
        """The restitution, as C has it: below zero where constraints that engage are to hold."""
        return -1.0 if self.restitution is None else self.restitution

    @property
    def cut(self) -> int:
        """What a crossing does, as sym_system's event_terminal has it at first.

        1: it ends the run; 2: the integration, until the action is done; 0: neither; -2: neither, and counts once.
        """
        return 1 if self.terminal else 2 if self.acts else -2 * self.once

    @property
    def acts(self) -> bool:
        """Whether something happens at a crossing."""
        return bool(self.action)


def with_stated(stated: Mapping[str, Event], given: Mapping[str, Any] | None) -> dict[str, Any]:
    """The events of a model and of who runs it.

    Args:
        stated: Those of the model.
        given: Name -> formula or Event, after the model's own; one of the same name stands in its place. None leaves
            out the model's.

    Raises:
        UnknownNameError: None is given for a name that the model's events do not have.
    """
    merged = {**stated, **(given or {})}
    for name in (name for name, event in merged.items() if event is None and name not in stated):
        rule, remedy = "None leaves out an event of the model", did_you_mean(name, stated) or "leave it out"
        found = ", ".join(stated) or "a model without events"
        raise UnknownNameError(f"events: no event '{name}' to leave out", found, rule, remedy)
    return {name: event for name, event in merged.items() if event is not None}


class Named(NamedTuple):
    """What actions may name.

    Attributes:
        par: Run-time parameters (npar).
        q: Coordinates (nq).
        v: Speeds (nv).
        held: Indices of the parameters that are poses which a constraint holds -> that constraint, what engages it.
    """

    par: Sequence[str]
    q: Collection[str]
    v: Sequence[str]
    held: Mapping[int, tuple[str, str]]

    def target(self, event: str, name: str) -> tuple[str, int]:
        """Group, "par" or "v", and index of what an action of an event sets.

        Raises:
            UnknownNameError: It names no run-time parameter or speed.
            SymofrosError: It names the pose that a constraint holds.
        """
        if found := coordinate_of(name, self.par):
            index = self.par.index(found)
            self._refuse_held(event, found, index)
            return "par", index
        if name in self.q:  # Of a joint with one coordinate that of its speed, too; in formulas it is the coordinate.
            what, rule = f"event '{event}': its action sets the coordinate '{name}'", "an action moves nothing at once"
            speed = f"its speed, '{speed_column(name, self.q)}'" if name in self.v else "speeds"
            remedy = f"set {speed}, or a parameter"
            raise UnknownNameError(what, f"'{name}' among coordinates", rule, remedy)
        if found := speed_of(name, self.v):
            return "v", self.v.index(found)
        known = [*self.par, *(speed_column(speed, self.q) for speed in self.v)]
        rule = "an action sets run-time parameters, and speeds: d and the coordinate's name, or the speed's own"
        what = f"event '{event}': its action sets '{name}', which is no parameter or speed"
        raise UnknownNameError(what, ", ".join(known[:12]) or "none", rule, did_you_mean(name, known))

    def targets(self, event: str, action: Collection[str]) -> list[tuple[str, int]]:
        """The same of all that an action sets.

        Raises:
            SymofrosError: It sets one thing twice; and as `target`.
        """
        places = list[tuple[str, int]]()
        for name in action:
            place = self.target(event, name)
            if place in places:
                what, rule = f"event '{event}': its action sets '{name}' twice", "one value for each"
                raise SymofrosError(what, ", ".join(action), rule, "leave one of them out")
            places.append(place)
        return places

    def _refuse_held(self, event: str, name: str, index: int) -> None:
        """Refuse to set the pose of the moment, which the constraint takes as it engages."""
        if index in self.held:
            constraint, engaged = self.held[index]
            what = f"event '{event}': its action sets '{name}'"
            rule = f"'{constraint}' holds the pose of the moment in which it engages"
            remedy = f"set what engages it, '{engaged}'; or give the switch the stated pose"
            raise SymofrosError(what, "the pose that a constraint holds", rule, remedy)
