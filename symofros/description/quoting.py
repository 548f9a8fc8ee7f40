"""Texts of formulas against the names that exist: what an author meant by one without backquotes, and a safe text."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from functools import lru_cache

from symofros.base.names import is_rate_symbol, quoted
from symofros.description.parser import ExpressionError, parse, tokenize
from symofros.errors import did_you_mean
from symofros.expr.expression import Expression, always_quoted, needs_quotes, spelled

_BETWEEN_QUOTES = re.compile(r"(`(?:[^`]|``)*`)")


def readings(text: str, symbols: Iterable[str]) -> list[tuple[str, str]]:
    """Other readings of a formula: each symbol that could be meant by an operation in it, and the text then.

    Args:
        text: Formula as it was written: "2*a-b".
        symbols: Symbols that exist; a symbol a-b gives the reading "2*`a-b`".
    """
    found: list[tuple[str, str]] = []
    if text.isidentifier():
        return found  # It holds no operation.
    for symbol in needs_quotes(symbol for symbol in symbols if symbol in text and _is_operation(symbol)):
        start = text.find(symbol)
        while start >= 0:
            other = f"{text[:start]}{quoted(symbol)}{text[start + len(symbol) :]}"
            if _symbols(other) and ("quoted", quoted(symbol), start) in tokenize(other):
                found.append((symbol, other))
                break
            start = text.find(symbol, start + 1)
    return found


@lru_cache(maxsize=1 << 12)
def _is_operation(symbol: str) -> bool:
    """Whether a name reads as a formula of others without quotes: a-b does, 1e3 and `c d` do not."""
    try:
        return bool(parse(symbol).args)
    except ExpressionError:
        return False


def with_quotes(text: str, symbols: Collection[str]) -> str:
    """A formula with backquotes around the names that need them, if it means something then; otherwise "".

    Args:
        text: Formula as it was written: "-20*left-hip".
        symbols: Symbols that exist, and may be used there.
    """
    changed = text
    for symbol in needs_quotes(symbol for symbol in symbols if symbol in text):
        whole = rf"(?<![\w.]){re.escape(symbol)}(?![\w.])"
        parts = _BETWEEN_QUOTES.split(changed)
        parts[::2] = [re.sub(whole, lambda _, name=symbol: quoted(name), part) for part in parts[::2]]
        changed = "".join(parts)
    used = _symbols(changed)
    return changed if changed != text and used and used <= {*symbols} else ""


def text_among(formula: Expression, symbols: Collection[str], both: Collection[str]) -> str:
    """A formula as text that nobody reads otherwise: with quotes around all names where one without could be another.

    Args:
        formula: The formula.
        symbols: All symbols of its description.
        both: Those of a coordinate and of another's rate as well.
    """
    text = str(formula)
    doubtful = readings(text, symbols) or (both and formula.symbols() & {*both})
    return formula.text(always_quoted) if doubtful else text


def without_quotes(formula: Expression, names: Collection[str]) -> list[str]:
    """Names, sorted, that occur without quotes in a formula as it was written."""
    if not names or not formula.written:
        return []
    return sorted({text for kind, text, _ in tokenize(formula.written) if kind == "name"} & {*names})


def two_meanings(formula: Expression, symbols: Collection[str]) -> tuple[str, str] | None:
    """A symbol that a formula as written could also mean, and the remedy; None where there is none.

    Args:
        formula: What the text was read as.
        symbols: Symbols that may be used there.
    """
    found = readings(formula.written, symbols) if formula.written else []
    if not found:
        return None
    symbol, other = found[0]
    return symbol, f"write {other} for what is called '{symbol}', or {formula.text(always_quoted)} for the operation"


def unknown_symbol_remedy(name: str, written: str, symbols: Collection[str]) -> str:
    """Remedy for an unknown symbol in a formula; "" where no name is similar.

    Args:
        name: Unknown symbol.
        written: Formula as it was written.
        symbols: Symbols that may be used there.
    """
    meant = with_quotes(written, symbols)
    if meant:
        return quotes_remedy(meant)
    return did_you_mean(name, {symbol for symbol in symbols if not is_rate_symbol(symbol)}, spelled)


def quotes_remedy(meant: str) -> str:
    """The remedy for a formula whose names lack their quotes."""
    return f"names of other signs than letters, digits and _ stand between backquotes: {meant}"


def _symbols(text: str) -> frozenset[str]:
    """Symbols of a text; none of one that is no formula."""
    try:
        return parse(text).symbols()
    except ExpressionError:
        return frozenset()
