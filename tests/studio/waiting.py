"""Waiting for a page: what is measured on one that still settles is asked until it holds."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # Others' tests wait as well, where there is no browser to be had.
    from playwright.sync_api import FloatRect, Locator, Page

PATIENCE = 120.0  # Software rendering on a busy machine [s].
_PAUSE_MS, _REST_MS = 100, 250


def until(page: Page, condition: Callable[[], bool], what: str = "it did not come to pass") -> None:
    """Ask until a condition holds, at least once; the test fails where it does not within PATIENCE."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, what
        page.wait_for_timeout(_PAUSE_MS)


def at_rest(element: Locator) -> FloatRect:
    """The box of an element once two looks find it at the same place."""
    found: list[FloatRect | None] = [None]

    def stays() -> bool:
        element.page.wait_for_timeout(_REST_MS)
        found.append(element.bounding_box())
        return found[-1] is not None and found[-1] == found[-2]

    until(element.page, stays, "it does not come to rest")
    box = found[-1]
    assert box is not None
    return box


def fits(page: Page, width: int) -> None:
    """Wait until the page is no wider than its window [pixels]."""
    wide = "document.documentElement.scrollWidth"
    until(page, lambda: bool(page.evaluate(wide) <= width), f"the page is wider than {width} pixels")


def lies_within(element: Locator, width: int, height: float = float("inf")) -> None:
    """Wait until an element lies between the sides of its page, and above its lower end [pixels]."""

    def lies() -> bool:
        box = element.bounding_box()
        return (
            box is not None
            and 0 <= box["x"]
            and box["x"] + box["width"] <= width
            and box["y"] + box["height"] <= height
        )

    until(element.page, lies, f"{element} lies outside the page")
