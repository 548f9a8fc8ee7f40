"""Routes: which method computes which quantity, when, and how exactly. One table, read by all that choose a method.

A route is one method for one quantity. Whoever has several methods calls `choose` with figures of the case at hand; the
first row of the quantity that applies and whose condition holds is taken, unless an option names another. What is
chosen is kept with the function that it serves, and `Model.routes` and `symofros info --routes` tell it. The page
docs/operations.md shows the table; a test compares them. To add a method: a row here, and its code where the
quantity is formed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from symofros.base.route import Choice as Choice
from symofros.base.route import Route as Route

# Figures of a case by name; what is costly to count is counted when a row asks for it.
Figures = Mapping[str, float | Callable[[], float]]

# Ratio of efforts up to which they don't tell which is the faster, from nineteen models (docs/theory/code.md,
# section 2).
TIE = 1.05
# Speeds that those of a joint are coupled with on its way to the base, on average, from which on articulated bodies
# take less: 0.8 of the effort of the factors or less in chains and flexible robots of 15 and more, and as much at 10
# (code.md, section 2). Counting both would take most of the time in which the function is generated.
COUPLED = 15
# Entries of the factors of M times columns, up to which derivatives are solved for by generated code.
MOST_STEPS = 96000
# Speeds coupled on average, as above, from which on derivatives of the acceleration take less by sweeps than by factors
# (code.md, section 2), and the most changes of forces that the routine's tables count.
SWEPT, MOST_CHANGES = 15, 32000
# Products of full matrices that one by tables may take the time of, with margin for what is gained by neither.
TABLE_PRODUCT = 8
# Packs are judged in functions of up to SHORT operations; longer ones gain on AVX2, and lose 4 % at most on AVX-512.
# They don't pay where the ratio of efforts, packs over scalars, is above MAX_STORED (above 1 where no lanes are stored
# together); on 512-bit vectors, where it is above MIN_DOUBT. From 21 functions of eight models (code.md, section 2).
SHORT, MAX_STORED, MIN_DOUBT = 1500, 1.03, 0.9
# Loops of a function leave out so many statements, and at least this share of all: where little repeats, they only cut
# straight code in pieces (M of a chain of 52 joints, of which 2 % was spared, took 15 % longer).
MIN_REPEATED, REPEATED_SHARE = 200, 0.5
# Vectors of equal limbs are formed where they spare this share of a function's operations.
LIMB_SHARE = 0.08


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
    """Whether products by index tables take no longer than those of full matrices, given the number of each."""
    return TABLE_PRODUCT * products <= full


def _packs_pay(f: Mapping[str, float]) -> bool:
    return bool(f["by_routine"]) or f["operations"] > SHORT or f["effort_ratio"] <= MIN_DOUBT


def _packs_cost(f: Mapping[str, float]) -> bool:
    return f["vectors"] == 0 or f["effort_ratio"] > (MAX_STORED if f["stored_together"] else 1.0)


def _loops_pay(f: Mapping[str, float]) -> bool:
    return f["repeated_statements"] >= max(MIN_REPEATED, REPEATED_SHARE * f["statements"])


def _never(_: Mapping[str, float]) -> bool:
    """The condition of methods that are taken where they are asked for alone."""
    return False


_EPS_COND = "eps times the condition of M"
_ANY_RANK = f"{_EPS_COND}; constraints of any rank"
_EXACT = "exact: differs by rounding alone"
_BITS = "the same bits as scalars"
_SHARING = "C of one state, where values of one state are formed by the same operations"
_ARTICULATED = "Options(forward_dynamics='articulated')"
_BY_ARTICULATED = Route(
    "articulated",
    "asked for only",
    "as the acceleration by articulated bodies",
    "linear.md, 10, (29), (30)",
    "as for the acceleration",
    _ARTICULATED,
    lambda f: f["distant_rotors"] == 0,
    _never,
)
# Quantity -> method -> row; in the order in which methods are tried.
ROUTES: dict[str, dict[str, Route]] = {}


def _quantity(name: str, *rows: Route) -> None:
    """Add the methods of a quantity to the table, in the order in which they are tried."""
    ROUTES[name] = {row.method: replace(row, quantity=name) for row in rows}


_quantity(
    "inertia forces", Route("recursion", "the only method", "rounding of sums of wrenches", "rigid.md, 3, (9), (10)")
)
_quantity(
    "acceleration of trees",
    Route(
        "articulated",
        f"speeds are coupled with {COUPLED} and more on average on their way to the base, or its effort is at most "
        f"{TIE} of that of the factors",
        "loses hundreds of times fewer digits where light links carry heavy loads",
        "rigid.md, 7.2, (39)-(46)",
        "every rotor is borne by the parent of the joint that drives it, or by the base",
        _ARTICULATED,
        lambda f: f["distant_rotors"] == 0,
        lambda f: f["coupled_speeds"] >= COUPLED or f["articulated_effort"] <= TIE * f["factors_effort"],
    ),
    Route(
        "factors",
        "articulated bodies take more, or do not apply",
        _EPS_COND,
        "rigid.md, 7.1",
        option="Options(forward_dynamics='factors')",
    ),
)
_quantity(
    "derivatives of the acceleration",
    _BY_ARTICULATED,
    Route(
        "sweeps",
        f"by q, v and u, where speeds are coupled with {SWEPT} and more on average on their way to the base, unless "
        "factors are asked for",
        "as the acceleration by articulated bodies",
        "linear.md, 10, (31)-(35)",
        "no beam deforms, no motion is prescribed, and all rotors are borne by the base",
        can=lambda f: f["elastic_beams"] == f["moving_rotors"] == f["prescribed_speeds"] == 0,
        when=lambda f: f["by_state"] == 1 and f["coupled_speeds"] >= SWEPT and f["direct_changes"] <= MOST_CHANGES,
    ),
    Route(
        "factors",
        f"entries of the factors of M times columns are at most {MOST_STEPS}",
        _EPS_COND,
        "linear.md, 1, (2)",
        when=lambda f: f["elimination_steps"] <= MOST_STEPS,
    ),
    Route("routine", "generated elimination would be long", _EPS_COND, "linear.md, 1, (2)"),
)
_quantity(
    "adjoint of the acceleration",
    replace(_BY_ARTICULATED, theory="linear.md, 5, (10)"),
    Route("factors", "unless the other is asked for", _EPS_COND, "linear.md, 5, (10)"),
)
_quantity(
    "constrained motion",
    Route(
        "multipliers",
        "unless the other is asked for",
        _ANY_RANK,
        "constraints.md, 4, (11)",
        option="Options(constraints='multipliers')",
    ),
    Route(
        "null_space",
        "asked for only",
        "condition of M on the free motions: keeps digits where M is nearly singular",
        "constraints.md, 8, (15)-(17)",
        option="Options(constraints='null_space')",
        when=_never,
    ),
)
_quantity(
    "constrained system",
    Route(
        "sparse",
        f"products by tables take at most 1/{TABLE_PRODUCT} of those of full matrices, in all functions of the library",
        f"{_EPS_COND}, refined once; falls back on full matrices where ranks are in doubt",
        "constraints.md, 12, (28)",
        when=lambda f: table_pays(f["table_products"], f["full_products"]),
    ),
    Route("dense", "tables would not pay", _ANY_RANK, "constraints.md, 4, (11)"),
)
_quantity(
    "derivatives of constrained motion",
    Route(
        "multipliers",
        "the only method, also where Options(constraints='null_space') is chosen",
        _ANY_RANK,
        "linear.md, 1, (2)",
    ),
)
_quantity(
    "second derivatives of the motion",
    Route(
        "multipliers",
        "the only method, of trees and under constraints, whatever is asked of the motion",
        f"{_EPS_COND}; constraints of full rank",
        "linear.md, 8, (23)",
    ),
)
_quantity(
    "derivatives of inertia forces",
    Route(
        "recursion",
        "whenever it applies",
        _EXACT,
        "linear.md, 7, (14)-(21)",
        "no beam deforms, and all rotors are borne by the base",
        can=lambda f: f["elastic_beams"] == 0 and f["moving_rotors"] == 0,
    ),
    Route("graph", "the recursion does not apply", _EXACT, "linear.md, 1"),
)
_quantity(
    "inverse dynamics by two speeds",
    Route(
        "mass matrix",
        "whenever it applies",
        _EXACT,
        "linear.md, 6, (11a)",
        "no beam deforms, and no ball or free joint drives rotors or armatures",
        can=lambda f: f["elastic_beams"] == 0 and f["turning_rotors"] == 0,
    ),
    Route("graph", "M does not determine them", _EXACT, "linear.md, 6, (11)"),
)
_quantity(
    "weighted second derivatives", Route("forward over reverse", "the only method", _EXACT, "linear.md, 8, (13), (22)")
)
_quantity("vector-Jacobian product", Route("reverse sweep", "the only method", _EXACT, "linear.md, 5, (8), (9)"))
_quantity(
    "values by vectors",
    Route(
        "packs",
        f"a routine finishes the function, it has more than {SHORT} operations, or effort by packs is at most "
        f"{MIN_DOUBT} of that by scalars",
        _BITS,
        "code.md, 2, (3)",
        _SHARING,
        can=lambda f: f["vectors"] > 0,
        when=_packs_pay,
    ),
    Route(
        "scalars",
        f"nothing shares vectors, or packs take more than {MAX_STORED} of the effort by scalars (than 1, where no "
        "lanes are stored together)",
        _BITS,
        "code.md, 2",
        option="Options(packs=False)",
        when=_packs_cost,
    ),
    Route(
        "by processor",
        "in between: packs on vectors of up to 256 bits, scalars on wider ones",
        _BITS,
        "code.md, 2",
        _SHARING,
        can=lambda f: f["vectors"] > 0,
    ),
)
_quantity(
    "equal parts",
    Route(
        "loops",
        f"loops leave out at least {MIN_REPEATED} statements and {REPEATED_SHARE:.0%} of all",
        _BITS,
        "code.md, 9",
        "parts of a mechanism repeat in the text",
        can=lambda f: f["repeated_statements"] > 0,
        when=_loops_pay,
    ),
    Route(
        "limbs",
        f"vectors of limbs spare more than {LIMB_SHARE:.0%} of the operations",
        _BITS,
        "code.md, 10",
        "C of one state, of a mechanism with equal limbs, not with Options(packs=False)",
        can=lambda f: f["limb_groups"] > 0,
        when=lambda f: f["spared_by_limbs"] > LIMB_SHARE * f["operations"],
    ),
    Route("one by one", "little repeats", _BITS, "code.md, 2"),
)
_quantity(
    "large batches",
    Route(
        "lanes",
        "whenever it applies",
        "rounding of one state; other pairs may be fused",
        "code.md, 3",
        "no routine finishes the function",
        "Options(batch='vector')",
        lambda f: f["by_routine"] == 0,
    ),
    Route(
        "state by state",
        "a routine finishes the function",
        "the bits of one state",
        "code.md, 3",
        option="Options(batch='loop')",
    ),
)
