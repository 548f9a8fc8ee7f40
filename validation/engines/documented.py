"""The table of engines in docs/engines.md: `python -m validation.engines.documented` writes it anew."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from .interface import EnginePlugin
from .plugins import OWN

PAGE = Path(__file__).parents[2] / "docs" / "engines.md"
BEGIN, END = "<!-- engines: begin -->", "<!-- engines: end -->"


def _engine(plugin: EnginePlugin) -> Iterator[str]:
    yield f"### {plugin.name}"
    yield ""
    yield f"`{plugin.package}`, brought by `{plugin.extra}`; {len(plugin.functions)} functions."
    if plugin.formats:
        yield f"Reads {', '.join(plugin.formats)}."
    yield ""
    yield "| what | convention |"
    yield "|---|---|"
    for row in plugin.conventions:
        yield f"| {row.what} | {row.convention.replace('|', chr(92) + '|')} |"
    yield ""


def table() -> str:
    """The conventions of all engines, as their plug-ins state them."""
    return "\n".join(line for name in sorted(OWN) for line in _engine(OWN[name])).rstrip()


def page(text: str) -> str:
    """The page with the table of now."""
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    return f"{before}{BEGIN}\n\n{table()}\n\n{END}{after}"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text()))
