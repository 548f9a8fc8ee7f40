"""What Stepper and Steppers share as objects of Python: what is set, copied and pickled, and what is refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from secrets import token_hex
from threading import Lock
from typing import Any, NoReturn

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.simulation.options import USUAL, SimulationOptions

# Times of steps are known to the step up to here.
MOST_STEPS = 1 << 53
# Attributes and what changes them.
_STATE, _MADE = (
    "reset(q, v, t) begins a motion at another state",
    "make another one, and reset it at this one's t, q, v",
)
_CHANGED_BY = dict.fromkeys(("t", "q", "v", "z"), _STATE) | dict.fromkeys(("model", "n", "dt", "inputs"), _MADE)
_CHANGED_BY |= {"u": "step(u) holds inputs", "par": "reset(q, v, t, par=...) begins with other parameters"}
# Arguments of other calls.
_ELSEWHERE = {
    "t_end": ("the loop that makes the steps decides when the motion ends", "leave it out"),
    "q0": ("a motion begins at a reset", "reset(q, v, t)"),
    "v0": ("a motion begins at a reset", "reset(q, v, t)"),
}


class Stepped:
    """Refuses what would silently do nothing, or share the memory that C steps in."""

    _stepping: Lock

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse to replace what only looks like the state or the settings."""
        if name in _CHANGED_BY and (name in vars(self) or hasattr(type(self), name)):
            what, rule = f"{type(self).__name__}: {name} is not assigned", "attributes tell what C steps with"
            raise SymofrosError(what, repr(value)[:60], rule, _CHANGED_BY[name])
        super().__setattr__(name, value)

    def _begin_alone(self) -> None:
        """Before steps, after which `_stepping` is released; another thread that calls meanwhile is refused."""
        if not self._stepping.acquire(blocking=False):
            raise self._occupied()

    def _occupied(self) -> SymofrosError:
        what, found = f"{type(self).__name__}: step", "another thread is within a step of the same one"
        return SymofrosError(
            what, found, "one thread at a time makes steps", "one for each thread, or a lock around the calls"
        )

    def __copy__(self) -> Any:
        """The same as copy(): two never share the memory that is stepped in."""
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        """The same as copy(); the model, which nothing changes, is shared."""
        return self.copy()

    def copy(self) -> Any:
        """Another one in the same state."""
        raise NotImplementedError

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        """Refuse to pickle memory of C."""
        rule = "a stepper is compiled code and memory of one process"
        remedy = "send t, q, v and par as arrays; there sf.compile, make one and reset it at them"
        raise SymofrosError(f"{type(self).__name__}: not pickled", repr(self), rule, remedy)


class SteppedModel(Stepped):
    """One model that is stepped, or motions of one."""

    @property
    def a(self) -> Array:
        """Accelerations v' (nv), of many (n, nv), at the present states and inputs, without stabilising terms."""
        return self._dynamics()[0]

    @property
    def lam(self) -> Array:
        """Multipliers (nc), of many (n, nc), as the accelerations."""
        return self._dynamics()[1]

    def _dynamics(self: Any) -> tuple[Array, Array]:
        a, lam, _ = self.model.constrained_dynamics(
            self.q, self.v, self.u, par=self.par, t=self.t, z=self.z if self.model.nz else None
        )
        return a, lam


def owner_of(what: str, name: str) -> str:
    """A name that no other one has, in no other process either: states go back to where they are of."""
    return f"{what} {token_hex(8)} of '{name}'"


def check_owner(state: Any, kind: type, owner: str, refused: tuple[str, str, str]) -> None:
    """Refuse to restore what `save` did not give.

    Args:
        state: What is to be restored.
        kind: Class of saved states.
        owner: What the state has to be of.
        refused: What was asked, the rule and the remedy.

    Raises:
        SymofrosError: It is no state, or one of another owner.
    """
    known = isinstance(state, kind)
    if known and state.owner == owner:
        return
    what, rule, remedy = refused
    found = f"a state of {state.owner}" if known else repr(state)[:60]
    raise SymofrosError(what, found, rule, remedy)


def no_steps(steps: object) -> SymofrosError:
    """The refusal of what is no number of steps."""
    rule, remedy = "steps is a whole number from 1 on", "leave it out for one step"
    return SymofrosError("step: no number of steps", repr(steps)[:60], rule, remedy)


def options_by_hand(
    options: SimulationOptions | None, changes: Mapping[str, Any], arguments: Sequence[str]
) -> SimulationOptions:
    """Options of stepping by hand.

    Args:
        options: Options to begin with; those by default if None.
        changes: Fields that replace theirs.
        arguments: Names of the other arguments of the call.

    Raises:
        SymofrosError: A name is that of an argument of another call.
        UnknownNameError: A name is no field.
    """
    for name in changes:
        if name in _ELSEWHERE:
            rule, remedy = _ELSEWHERE[name]
            raise SymofrosError(f"stepper: no option '{name}'", name, rule, remedy)
    return (options or USUAL).changed(changes, arguments)
