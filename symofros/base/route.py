"""A route, one method for one quantity, and the choice of one: what the table of `routes.py` is made of and answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

Condition = Callable[[Mapping[str, float]], bool]


def always(_: Mapping[str, float]) -> bool:
    """The condition that holds in every case."""
    return True


@dataclass(frozen=True)
class Route:
    """One method for one quantity: a row of the table.

    Attributes:
        method: Name of the method.
        chosen: When it is taken, in words: the first row of its quantity that applies and for which this holds.
        accuracy: What it keeps.
        theory: Page of docs/theory, section and equations.
        applies: When it can be used, in words.
        option: The option that asks for it; "" where none does.
        can: Whether it can be used, from the figures of a case.
        when: Whether it is taken, from the figures of a case.
        quantity: What is computed; the table fills it in.
    """

    method: str
    chosen: str
    accuracy: str
    theory: str
    applies: str = "always"
    option: str = ""
    can: Condition = field(default=always, repr=False, compare=False)
    when: Condition = field(default=always, repr=False, compare=False)
    quantity: str = ""


@dataclass(frozen=True)
class Choice:
    """The route that a function took, and why.

    Attributes:
        route: The row of the table.
        figures: Figures that decided, by name.
        asked: Whether an option asked for it, and no figure decided.
        others: Other routes that apply to the case.
    """

    route: Route
    figures: Mapping[str, float] = field(default_factory=dict, hash=False)
    asked: bool = False
    others: tuple[Route, ...] = ()

    @property
    def quantity(self) -> str:
        """Name of the computed quantity."""
        return self.route.quantity

    @property
    def method(self) -> str:
        """Name of the method."""
        return self.route.method

    @property
    def reason(self) -> str:
        """Why it was taken, in words."""
        return f"asked for: {self.route.option}" if self.asked else self.route.chosen

    @property
    def counted(self) -> str:
        """The figures that decided and are not zero, in words."""
        return ", ".join(f"{name.replace('_', ' ')} {value:.5g}" for name, value in self.figures.items() if value)

    def __str__(self) -> str:
        """The choice on one line: quantity, method, reason, and how to ask for others."""
        others = " or ".join(f"{route.method} by {route.option}" for route in self.others if route.option)
        parts = (self.reason, self.counted, f"else {others}" if others else "")
        return f"{self.quantity}: {self.method}; {'; '.join(filter(None, parts))}"

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        return {
            "quantity": self.quantity,
            "method": self.method,
            "why": self.reason,
            "asked": self.asked,
            "figures": dict(self.figures),
            "accuracy": self.route.accuracy,
            "theory": self.route.theory,
            "others": [{"method": route.method, "option": route.option} for route in self.others],
        }
