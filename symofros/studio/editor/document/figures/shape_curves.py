"""Curves of a beam's shape functions, for a little plot."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np

from symofros.description import Direction, Family, Samples, UserShape, as_value
from symofros.errors import DescriptionError, did_you_mean
from symofros.mechanics.beams import MAX_MODES, THEORIES, FamilyError
from symofros.studio.editor.editing.data_edits import EditError

POINTS = 65


def curves(body: dict[str, Any]) -> dict[str, Any]:
    """The shape functions that a request names: `xi`, and for each its `values` and whether it is a length.

    Raises:
        EditError: There are no such functions.
    """
    family, direction, count = body.get("family", "spline"), body.get("direction", "bend_y"), body.get("modes", 1)
    if family not in get_args(Family):
        raise _wrong("family", family, ", ".join(get_args(Family)), did_you_mean(str(family)[:100], get_args(Family)))
    if direction not in get_args(Direction):
        raise _wrong("direction", direction, ", ".join(get_args(Direction)), "choose one of them")
    if type(count) is not int or not 0 <= count <= MAX_MODES:
        raise _wrong("modes", count, f"0 to {MAX_MODES}", "give a number")
    stations = np.linspace(0.0, 1.0, POINTS).tolist()
    try:
        stated = _user(body.get("shapes"))
        theory = THEORIES.get(body.get("theory", ""), THEORIES["second_order"])
        functions = theory.family_functions(family, direction, count, stated)
        lines = [{"values": function.rounded(stations), "length": length} for function, length in functions]
    except FamilyError as error:
        raise _wrong(
            f"family '{family}'",
            str(error),
            "each family has its own functions",
            "change the number of functions, or the family",
        ) from None
    except (DescriptionError, ValueError, KeyError, TypeError, ArithmeticError) as error:
        raise _wrong("shapes", str(error)[:200], "formulas of xi, or samples", "mend them") from None
    return {"xi": stations, "curves": lines}


def _user(given: Any) -> tuple[UserShape, ...]:
    """The user's own functions, as a file states them."""
    if not isinstance(given, list):
        return ()
    return tuple(
        Samples(tuple(item["xi"]), tuple(item["values"])) if isinstance(item, dict) else as_value(item)
        for item in given[:MAX_MODES]
    )


def _wrong(what: str, found: Any, rule: str, remedy: str) -> EditError:
    return EditError(f"{what}: no shape functions", f"{found!s:.200}", rule, remedy)
