"""What is put into the head of viser's page: a title, and what helps those who do not see the page."""

from __future__ import annotations

import html
from functools import cache
from importlib.resources import files

VISER_TITLE = "<title>Viser</title>"


def page_head(title: str) -> str:
    """What takes the place of VISER_TITLE.

    Args:
        title: Title of the page, which its tab shows.
    """
    return f"<title>{html.escape(title)}</title>{fragment('access.html')}"


@cache
def fragment(name: str) -> str:
    """A file of this package, as text."""
    return (files("symofros.studio.viewer.page") / name).read_text(encoding="utf-8")
