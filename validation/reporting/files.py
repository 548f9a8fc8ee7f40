"""Record -> check.html (one self-contained page), check.md (a summary), check.json (everything)."""

from __future__ import annotations

from pathlib import Path

from markupsafe import Markup

from validation.adapters import ROUTES, differences
from validation.comparison.errors import Comparison
from validation.contract.quantities import MOTION_ENERGY, QUANTITIES, ROUNDING, SMALL, SOLVE
from validation.reporting.figures import error_against_condition, error_distributions
from validation.reporting.page import render, write_pages
from validation.reporting.record import Record, to_json
from validation.reporting.tables import COLUMNS, by_engine, by_model, failures, headline, short, unsupported, worst


def write_report(record: Record, folder: Path) -> Path:
    """Write the three files.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    texts = {"check.md.j2": to_markdown, "check.html.j2": to_html}
    return write_pages(folder, "check", to_json(record), lambda template: texts[template](record))


def to_html(record: Record) -> str:
    """The page: figures and tables inside, nothing from outside."""
    engines = [name for name in ROUTES if any(row.engine == name for row in record.compared)]
    return _render(
        "check.html.j2",
        record,
        distributions=Markup(error_distributions(record)),
        conditions=Markup(error_against_condition(record)),
        engines=engines,
        independent=[name for name in engines if ROUTES[name].independent],
        lines_of={name: by_engine(record, engines=(name,)) for name in engines},
        drifts=[row for row in record.comparisons if row.quantity == "energy_drift" and row.error is not None],
        quantities=[*QUANTITIES.values(), MOTION_ENERGY],
        differences=differences(),
    )


def to_markdown(record: Record) -> str:
    """The summary: verdict, one line a model, what is wrong, what could not be compared."""
    return _render("check.md.j2", record)


def _render(template: str, record: Record, **more: object) -> str:
    return render(
        template,
        {"short": _short, "cell": _markdown_cell},
        record=record,
        headline=headline(record),
        columns=COLUMNS,
        models=by_model(record),
        failures=failures(record),
        unsupported=unsupported(record),
        rounding=worst(_rounded(record)),
        solve=worst(row for row in record.compared if row.quantity == "forward_dynamics"),
        ROUNDING=ROUNDING,
        SOLVE=SOLVE,
        SMALL=SMALL,
        **more,
    )


def _rounded(record: Record) -> list[Comparison]:
    """The comparisons that nothing but rounding stands between."""
    rounded = {quantity.name for quantity in (*QUANTITIES.values(), MOTION_ENERGY) if quantity.tolerance == ROUNDING}
    return [row for row in record.compared if row.quantity in rounded]


def _short(number: float | None) -> str:
    return "NaN" if number is None else short(number)


def _markdown_cell(text: object) -> str:
    """A text that can't end the cell it stands in."""
    return " ".join(str(text).replace("|", "\\|").split())
