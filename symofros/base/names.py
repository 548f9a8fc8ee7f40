"""Names that users choose against names that formulas reserve: what formulas, columns and tables call a thing."""

from __future__ import annotations

QUOTE = "`"
TIME = "t"
# What these mean in formulas is fixed: the time, and a number.
RESERVED = frozenset({TIME, "pi"})


def quoted(name: str) -> str:
    """A name between backquotes; one within it is doubled."""
    return f"{QUOTE}{name.replace(QUOTE, 2 * QUOTE)}{QUOTE}"


def unquoted(text: str) -> str:
    """The name that a quoted text stands for."""
    return text[1:-1].replace(2 * QUOTE, QUOTE)


def symbol_of(name: str) -> str:
    """The symbol of a coordinate, speed or input in formulas and columns: its name, but "`t`" for one called t.

    Within the program a symbol is the plain name, whatever signs it holds; formulas print it with backquotes where
    they need them. A reserved name bears them everywhere, as it would mean something else without.
    """
    return quoted(name) if name in RESERVED else name


def speed_column(coordinate: str, coordinates: tuple[str, ...]) -> str:
    """Name of the column of a coordinate's rate: d and its name, which is quoted where a coordinate has that name."""
    plain = f"d{coordinate}"
    return plain if plain not in coordinates else f"d{quoted(coordinate)}"
