"""Report -> one self-contained page: nothing from outside, readable on a phone, light or dark.

Pages hold no script, but for the one that looks through a `Search`.
"""

from __future__ import annotations

import re
from html import escape
from pathlib import Path

from .charts import PALETTE, draw
from .evidence import standing_text
from .figures import Chart, Drawing, Figure
from .provenance import Provenance
from .record import MISSED, SHORT, Block, Bullets, Cell, Code, Fact, Report, Search, Section, Table, Text

_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<main{kind}>
{body}
</main>
</body>
</html>
"""
_SEARCH = """<div class="search"><label>Look for <input type="search" placeholder="{examples}"></label>
<p class="soft" role="status"></p>{table}<script>
{script}</script></div>"""
# [text](place in a report, or an address).
_LINK = re.compile(r"\[([^\]]+)\]\((https://[\w.#/-]+|[#\w][\w.#/-]*)\)")
# Tones of verdicts in the style sheet.
_TONE = {True: "good", False: "bad", None: "soft"}
# Where a table is too wide, and from which width on [px]: on any page, or on a phone.
_PAGES = {"wide": 1052.0, "phone": 360.0}
# Tables of more columns are set closer.
_MANY_COLUMNS = 11
# Lines of what is missed that stand on the page unfolded.
_FEW = 6
# Width that a phone shows whole [px].
_PHONE = 320.0


def page(report: Report, provenance: Provenance | None = None, closing: str = "", listed: bool = True) -> str:
    """The page.

    Args:
        report: Report to render.
        provenance: Origin of the numbers, stated at the end.
        closing: Last line.
        listed: Whether sections that can be linked to are folded, where there are several: their headings are the list.
    """
    links = [section for section in report.sections if section.anchor] if listed else []
    standing = provenance.standing if provenance else ""
    parts = [
        f"<h1>{escape(report.title)}</h1>",
        f'<p class="verdict {_TONE[report.ok]}">{prose(report.summary)}</p>',
        block(Text(f"This report {standing_text(standing)}.", "short")) if standing else "",
        *(f'<div class="decisions">{block(one)}</div>' for one in report.decisions),
        _missed(report),
        f'<div class="tiles">{"".join(map(tile, report.facts))}</div>' if report.facts else "",
        *map(block, report.blocks),
        *(section(one, k + 1, folded=len(links) > 1) for k, one in enumerate(report.sections)),
    ]
    if provenance is not None:
        parts += ["<h2>Versions and machine</h2>", table(Table(("what", "value"), provenance.rows))]
    parts.append(block(Text(closing, "soft")) if closing else "")
    style = Path(__file__).with_name("style.css").read_text(encoding="utf-8")
    light, dark = (" ".join(f"--{name}: {pair[k]};" for name, pair in PALETTE.items()) for k in (0, 1))
    style = f":root {{ {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n{style}"
    kind = ' class="aims"' if report.aims else ""
    return _PAGE.format(title=escape(report.title), style=style, kind=kind, body="\n".join(filter(None, parts)))


def _missed(report: Report) -> str:
    """What is missed; more than a few lines are folded."""
    if not report.missed:
        return ""
    title = "Targets of ours that are missed" if report.aims else "Missed"
    if len(report.missed) > _FEW:
        return block(Section(f"{title}: {len(report.missed)}", (Bullets(report.missed),)))
    return block(Text(f"**{title}:**", "bad")) + block(Bullets(report.missed))


def prose(text: str) -> str:
    """Escaped, with `code`, **bold** and [links](#anchor) set as such; links lead into the reports, or to https."""
    text = re.sub("`([^`]+)`", r"<code>\1</code>", escape(" ".join(text.split()), quote=False))
    text = re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", text)
    return _LINK.sub(r'<a href="\2">\1</a>', text)


def tile(fact: Fact) -> str:
    """A key number."""
    tone = "" if fact.ok is None else _TONE[fact.ok]
    return f'<div class="tile"><b class="{tone}">{escape(fact.value)}</b><span>{prose(fact.label)}</span></div>'


def section(one: Section, number: int, folded: bool = False) -> str:
    """A section; its figures are numbered within it. One that misses something is never folded."""
    badge = f' <span class="badge {_TONE[one.ok]}">{escape(one.badge)}</span>' if one.badge else ""
    mark = " <b class=bad>missed</b>" if folded and one.ok is False else ""
    figures, parts = 0, []
    for item in one.blocks:
        figures += isinstance(item, Figure)
        parts.append(block(item, f"Figure {number}.{figures}."))
    inner, heading = "\n".join(parts), f"{prose(one.title)}{badge}{mark}"
    if not (folded and one.anchor):
        anchor = f' id="{escape(one.anchor)}"' if one.anchor else ""
        return f"<h2{anchor}>{heading}</h2>\n{inner}"
    opened = " open" if one.ok is False else ""
    # As in a fold of a section, a link to the anchor opens it.
    return (
        f'<details class="section"{opened}><summary><h2>{heading}</h2></summary>\n'
        f'<div id="{escape(one.anchor)}">{inner}</div></details>'
    )


def block(item: Block, figure_name: str = "") -> str:
    """Any block."""
    match item:
        case str():
            return f"<p>{prose(item)}</p>"
        case Text(text, tone):
            return f'<p class="{tone}">{prose(text)}</p>'
        case Code(text):
            return f'<pre tabindex="0">{escape(text)}</pre>'
        case Table():
            return table(item)
        case Search(searched, examples):
            return _SEARCH.format(examples=escape(", ".join(examples)), table=table(searched), script=_script())
        case Bullets(items):
            return f"<ul>{''.join(f'<li>{prose(one)}</li>' for one in items)}</ul>"
        case Figure(_, ()):
            return ""
        case Figure(caption, charts):
            name = f"<b>{figure_name}</b> " if figure_name else ""
            said = f"<figcaption>{name}{prose(caption)}</figcaption>" if caption else ""
            return f'<figure><div class="charts">{"".join(map(chart, charts))}</div>{said}</figure>'
        case Section(title, blocks, anchor, ok):
            inner = "\n".join(map(block, blocks))
            # The anchor is within the fold, so that a link to it opens it.
            inner = f'<div id="{escape(anchor)}">{inner}</div>' if anchor else inner
            return f"<details{' open' if ok is False else ''}><summary>{prose(title)}</summary>\n{inner}</details>"


def _script() -> str:
    return Path(__file__).with_name("search.js").read_text(encoding="utf-8")


def chart(item: Chart | Drawing) -> str:
    """HTML of a picture under its title, or of a note on the package that drawing it needs."""
    try:
        picture = f'<div class="scroll" tabindex="0">{draw(item)}</div>'
    except ModuleNotFoundError as error:
        picture = block(Text(f"Not drawn: {error}.", "soft"))
    small = " small" if item.size[0] < _PHONE else ""
    return f'<div class="chart{small}"><h3>{escape(item.title)}</h3>{picture}</div>'


def table(item: Table) -> str:
    """A table that scrolls by itself where it is wider than the page."""
    dense, numeric = len(item.head) > _MANY_COLUMNS, item.numeric
    rows = [[one if isinstance(one, Cell) else Cell(one) for one in row] for row in (item.head, *item.rows)]
    groups = [""] * len(rows)
    if item.grouped:
        groups = ["", *(row[0].text for row in rows[1:])]
        rows, numeric = [row[1:] for row in rows], numeric[1:]
    tags = ["th"] + ["td"] * len(item.rows)
    lines = [
        "".join(cell(*one, tag) for one in zip(row, numeric, strict=True)) for row, tag in zip(rows, tags, strict=True)
    ]
    above = f'<tr class="group"><th scope="rowgroup" colspan="{len(numeric)}"><div>{{}}</div></th></tr>\n'
    body = "\n".join(
        f"{above.format(prose(group)) if group else ''}<tr>{line}</tr>"
        for group, line in zip(groups, lines, strict=True)
    )
    # About how wide a column is: numbers stay on a line, other texts break between words.
    letter, padding = (6.4, 6.0) if dense else (7.2, 16.0)
    columns = [
        [
            one.text if n and k else max(_LINK.sub(r"\1", one.text).split(), key=len, default="")
            for k, one in enumerate(column)
        ]
        for column, n in zip(zip(*rows, strict=True), numeric, strict=True)
    ]
    width = sum(padding + letter * max(3, *map(len, column)) for column in columns)
    kind = next((kind for kind, room in _PAGES.items() if width > room), "")
    cue = f'<p class="cue {kind}">Wider than the page: scroll it sideways.</p>' if kind else ""
    kinds = " ".join(["dense"] * dense + ["grouped"] * item.grouped)
    kinds = f' class="{kinds}"' if kinds else ""
    return f'{cue}<div class="scroll" tabindex="0"><table{kinds}>\n{body}\n</table></div>'


def cell(item: Cell, is_number: bool, tag: str) -> str:
    """A cell of a table: of its head (th) or of its body (td)."""
    marks = {"wrong": MISSED, "short": SHORT}
    marked = [name for name, mark in marks.items() if item.text.startswith(mark)]
    kinds = " ".join(["n"] * is_number + marked)
    attributes = f' class="{kinds}"' if kinds else ""
    attributes += f' style="background: rgba(var(--shade), {item.shade:.2f})"' if item.shade else ""
    attributes += f' title="{escape(item.hint)}"' if item.hint else ""
    return f"<{tag}{attributes}>{prose(item.text.removeprefix(MISSED).removeprefix(SHORT))}</{tag}>"
