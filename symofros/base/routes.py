"""Routes: which method computes which quantity, when, and how exactly. One table, read by all that choose a method.

A route is one method for one quantity. Whoever has several methods calls `choose` with figures of the case at hand; the
first row of the quantity that applies and whose condition holds is taken, unless an option names another. What is
chosen is kept with the function that it serves, and `Model.routes` and `symofros info --routes` tell it. The page
docs/operations.md shows the table; a test compares them. To add a method: a row here, and its code where the
quantity is formed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

# Figures of a case by name; what is costly to count is counted when a row asks for it.
Figures = Mapping[str, float | Callable[[], float]]
Condition = Callable[[Mapping[str, float]], bool]

# Ratio of efforts up to which they don't tell which is the faster, from nineteen models (docs/theory/code.md,
# section 2).
TIE = 1.05
# Entries of the factors of M times columns, up to which derivatives are solved for by generated code.
MOST_STEPS = 96000
# Products of full matrices that one by tables may take the time of, with margin for what is gained by neither.
TABLE_PRODUCT = 8
# Packs are judged in functions of up to SHORT operations; longer ones gain on AVX2, and lose 4 % at most on AVX-512.
# They don't pay where the ratio of efforts, packs over scalars, is above MOST_STORED (above 1 where no lanes are stored
# together); on 512-bit vectors, where it is above LEAST_DOUBT. From 21 functions of eight models (code.md, section 2).
SHORT, MOST_STORED, LEAST_DOUBT = 1500, 1.03, 0.9
# Loops of a function leave out so many statements, and at least this share of all: where little repeats, they only cut
# straight code in pieces (M of a chain of 52 joints, of which 2 % was spared, took 15 % longer).
LEAST_REPEATED, REPEATED_SHARE = 200, 0.5
# Vectors of equal limbs are formed where they spare this share of a function's operations.
LIMB_SHARE = 0.08


def _always(_: Mapping[str, float]) -> bool:
    return True


@dataclass(frozen=True)
class Route:
    """One method for one quantity: a row of the table.

    Attributes:
        quantity: What is computed.
        method: Name of the method.
        applies: When it can be used, in words.
        chosen: When it is taken, in words: the first row of its quantity that applies and for which this holds.
        accuracy: What it keeps.
        theory: Page of docs/theory, section and equations.
        option: The option that asks for it; "" where none does.
        can: Whether it can be used, from the figures of a case.
        when: Whether it is taken, from the figures of a case.
    """

    quantity: str
    method: str
    applies: str
    chosen: str
    accuracy: str
    theory: str
    option: str = ""
    can: Condition = field(default=_always, repr=False, compare=False)
    when: Condition = field(default=_always, repr=False, compare=False)


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
    figures: Mapping[str, float] = field(default_factory=dict)
    asked: bool = False
    others: tuple[Route, ...] = ()

    @property
    def quantity(self) -> str:
        """What is computed."""
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
        """In one line: quantity, method, reason, and how to ask for others."""
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


class _Counted(dict[str, float]):
    """Figures of a case that rows have asked for, each counted once."""

    def __init__(self, figures: Figures) -> None:
        super().__init__()
        self._figures = figures

    def __missing__(self, name: str) -> float:
        figure = self._figures[name]
        self[name] = value = figure() if callable(figure) else figure
        return value


def choose(quantity: str, figures: Figures | None = None, asked: str = "") -> Choice:
    """The route of a quantity.

    Args:
        quantity: A quantity of the table.
        figures: Figures of the case that its rows ask for.
        asked: Method that an option asks for, which is taken whether it applies or not: who forms the quantity refuses
            what can't be formed; "" for none.

    Raises:
        KeyError: There is no such quantity, method or figure.
    """
    rows, counted = ROUTES[quantity], _Counted(figures or {})
    if asked:
        route = rows[asked]
    else:
        route = next(row for row in rows.values() if row.can(counted) and row.when(counted))
    decided = {} if asked else dict(counted)
    others = tuple(row for row in rows.values() if row is not route and row.can(counted))
    return Choice(route, decided, bool(asked), others)


def taken(quantity: str, method: str) -> Choice:
    """A route that a caller asks for, of a case that it tells nothing of."""
    return Choice(ROUTES[quantity][method], asked=True)


def table_pays(products: float, full: float) -> bool:
    """Whether products by tables take less time than those of full matrices."""
    return TABLE_PRODUCT * products <= full


def _packs_pay(f: Mapping[str, float]) -> bool:
    return bool(f["by_routine"]) or f["operations"] > SHORT or f["effort_ratio"] <= LEAST_DOUBT


def _packs_cost(f: Mapping[str, float]) -> bool:
    return f["vectors"] == 0 or f["effort_ratio"] > (MOST_STORED if f["stored_together"] else 1.0)


def _loops_pay(f: Mapping[str, float]) -> bool:
    return f["repeated_statements"] >= max(LEAST_REPEATED, REPEATED_SHARE * f["statements"])


_EPS_COND = "eps times the condition of M"
_EXACT = "exact: differs by rounding alone"
_BITS = "the same bits as scalars"
_FORWARD, _KEEP, _TEXT = "Options(forward_dynamics='{}')", "Options(constraints='{}')", "Options(packs=False)"

_ROWS = (
    Route(
        "inertia forces",
        "recursion",
        "always",
        "the only method",
        "rounding of sums of wrenches",
        "rigid.md, 3, (9), (10)",
    ),
    Route(
        "acceleration of trees",
        "articulated",
        "every rotor is borne by the parent of the joint that drives it, or by the base",
        f"its effort is at most {TIE} of that of the factors",
        "loses hundreds of times fewer digits where light links carry heavy loads",
        "rigid.md, 7.2, (39)-(46)",
        _FORWARD.format("articulated"),
        lambda f: f["distant_rotors"] == 0,
        lambda f: f["articulated_effort"] <= TIE * f["factors_effort"],
    ),
    Route(
        "acceleration of trees",
        "factors",
        "always",
        "articulated bodies take more, or do not apply",
        _EPS_COND,
        "rigid.md, 7.1",
        _FORWARD.format("factors"),
    ),
    Route(
        "constrained motion",
        "multipliers",
        "always",
        "unless the other is asked for",
        f"{_EPS_COND}; constraints of any rank",
        "constraints.md, 4, (11)",
        _KEEP.format("multipliers"),
    ),
    Route(
        "constrained motion",
        "null_space",
        "always",
        "asked for only",
        "condition of M on the free motions: keeps digits where M is nearly singular",
        "constraints.md, 8, (15)-(17)",
        _KEEP.format("null_space"),
    ),
    Route(
        "constrained system",
        "sparse",
        "forward dynamics by multipliers, and projection",
        f"products by tables take at most 1/{TABLE_PRODUCT} of those of full matrices, in all functions of the library",
        f"{_EPS_COND}, refined once; falls back on full matrices where ranks are in doubt",
        "constraints.md, 12, (28)",
        when=lambda f: table_pays(f["table_products"], f["full_products"]),
    ),
    Route(
        "constrained system",
        "dense",
        "always",
        "tables would not pay",
        f"{_EPS_COND}; constraints of any rank",
        "constraints.md, 4, (11)",
    ),
    Route(
        "derivatives of the acceleration",
        "articulated",
        "as for the acceleration",
        "asked for only",
        "as the acceleration by articulated bodies",
        "linear.md, 10, (29), (30)",
        _FORWARD.format("articulated"),
        lambda f: f["distant_rotors"] == 0,
        lambda f: False,
    ),
    Route(
        "derivatives of the acceleration",
        "factors",
        "always",
        f"entries of the factors of M times columns are at most {MOST_STEPS}",
        _EPS_COND,
        "linear.md, 1, (2)",
        when=lambda f: f["elimination_steps"] <= MOST_STEPS,
    ),
    Route(
        "derivatives of the acceleration",
        "routine",
        "always",
        "generated elimination would be long",
        _EPS_COND,
        "linear.md, 1, (2)",
    ),
    Route(
        "adjoint of the acceleration",
        "articulated",
        "as for the acceleration",
        "asked for only",
        "as the acceleration by articulated bodies",
        "linear.md, 5, (10)",
        _FORWARD.format("articulated"),
        lambda f: f["distant_rotors"] == 0,
        lambda f: False,
    ),
    Route(
        "adjoint of the acceleration",
        "factors",
        "always",
        "unless the other is asked for",
        _EPS_COND,
        "linear.md, 5, (10)",
    ),
    Route(
        "derivatives of constrained motion",
        "multipliers",
        "always",
        "the only method, also where Options(constraints='null_space') is chosen",
        f"{_EPS_COND}; constraints of any rank",
        "linear.md, 1, (2)",
    ),
    Route(
        "second derivatives of the motion",
        "multipliers",
        "always",
        "the only method, of trees and under constraints, whatever is asked of the motion",
        f"{_EPS_COND}; constraints of full rank",
        "linear.md, 8, (23)",
    ),
    Route(
        "derivatives of inertia forces",
        "recursion",
        "no beam deforms, and all rotors are borne by the base",
        "whenever it applies",
        _EXACT,
        "linear.md, 7, (14)-(21)",
        can=lambda f: f["elastic_beams"] == 0 and f["moving_rotors"] == 0,
    ),
    Route(
        "derivatives of inertia forces",
        "graph",
        "always",
        "the recursion does not apply",
        _EXACT,
        "linear.md, 1",
    ),
    Route(
        "inverse dynamics by two speeds",
        "mass matrix",
        "no beam deforms, and no ball or free joint drives rotors or armatures",
        "whenever it applies",
        _EXACT,
        "linear.md, 6, (11a)",
        can=lambda f: f["elastic_beams"] == 0 and f["turning_rotors"] == 0,
    ),
    Route(
        "inverse dynamics by two speeds",
        "graph",
        "always",
        "M does not determine them",
        _EXACT,
        "linear.md, 6, (11)",
    ),
    Route(
        "weighted second derivatives",
        "forward over reverse",
        "always",
        "the only method",
        _EXACT,
        "linear.md, 8, (13), (22)",
    ),
    Route(
        "vector-Jacobian product",
        "reverse sweep",
        "always",
        "the only method",
        _EXACT,
        "linear.md, 5, (8), (9)",
    ),
    Route(
        "values by vectors",
        "packs",
        "C of one state, where values of one state are formed by the same operations",
        f"a routine finishes the function, it has more than {SHORT} operations, or effort by packs is at most "
        f"{LEAST_DOUBT} of that by scalars",
        _BITS,
        "code.md, 2, (3)",
        can=lambda f: f["vectors"] > 0,
        when=_packs_pay,
    ),
    Route(
        "values by vectors",
        "scalars",
        "always",
        f"nothing shares vectors, or packs take more than {MOST_STORED} of the effort by scalars (than 1, where no "
        "lanes are stored together)",
        _BITS,
        "code.md, 2",
        _TEXT,
        when=_packs_cost,
    ),
    Route(
        "values by vectors",
        "by processor",
        "as packs",
        "in between: packs on vectors of up to 256 bits, scalars on wider ones",
        _BITS,
        "code.md, 2",
        can=lambda f: f["vectors"] > 0,
    ),
    Route(
        "values by vectors",
        "timed",
        "as packs",
        "asked for only: packs or scalars, whichever ran faster on this machine",
        _BITS,
        "code.md, 2",
        "Options(tune=True)",
        lambda f: f["vectors"] > 0,
        lambda f: False,
    ),
    Route(
        "equal parts",
        "loops",
        "parts of a mechanism repeat in the text",
        f"loops leave out at least {LEAST_REPEATED} statements and {REPEATED_SHARE:.0%} of all",
        _BITS,
        "code.md, 9",
        can=lambda f: f["repeated_statements"] > 0,
        when=_loops_pay,
    ),
    Route(
        "equal parts",
        "limbs",
        "C of one state, of a mechanism with equal limbs, not with Options(packs=False)",
        f"vectors of limbs spare more than {LIMB_SHARE:.0%} of the operations",
        _BITS,
        "code.md, 10",
        can=lambda f: f["limb_groups"] > 0,
        when=lambda f: f["spared_by_limbs"] > LIMB_SHARE * f["operations"],
    ),
    Route(
        "equal parts",
        "one by one",
        "always",
        "little repeats",
        _BITS,
        "code.md, 2",
    ),
    Route(
        "large batches",
        "lanes",
        "no routine finishes the function",
        "whenever it applies",
        "rounding of one state; other pairs may be fused",
        "code.md, 3",
        "Options(batch='vector')",
        lambda f: f["by_routine"] == 0,
    ),
    Route(
        "large batches",
        "state by state",
        "always",
        "a routine finishes the function",
        "the bits of one state",
        "code.md, 3",
        "Options(batch='loop')",
    ),
)
# Quantity -> method -> row; in the order in which methods are tried.
ROUTES: dict[str, dict[str, Route]] = {}
for _row in _ROWS:
    ROUTES.setdefault(_row.quantity, {})[_row.method] = _row
