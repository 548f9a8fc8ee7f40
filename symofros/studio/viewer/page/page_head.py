"""What is put into the head of viser's page: a title, and what helps those who do not see the page."""

from __future__ import annotations

import html
from functools import cache
from importlib.resources import files

VISER_TITLE = "<title>Viser</title>"


# viser's panel, known by its sign of the connection, lies over the picture with nothing in it as well.
_NO_PANEL = '<style>.mantine-Paper-root:has([class*="tabler-icon-cloud"]) { display: none !important; }</style>'


def page_head(title: str, panel: bool = True) -> str:
    """HTML that replaces VISER_TITLE in the head of a page.

    Args:
        title: Title of the page, which its tab shows.
        panel: Whether the page has a panel of controls.
    """
    plots = f"<script>{fragment('plot.js')}</script>"
    return f"<title>{html.escape(title)}</title>{fragment('access.html')}{plots}{'' if panel else _NO_PANEL}"


@cache
def fragment(name: str, folder: str = "page") -> str:
    """A file of the viewer's package `page`, or of another folder of the viewer, as text."""
    return (files(f"symofros.studio.viewer.{folder}") / name).read_text(encoding="utf-8")
