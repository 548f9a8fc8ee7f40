"""What a page draws in three dimensions, as tests see it: its picture, and when that has come to rest."""

from __future__ import annotations

import io
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from tests.studio.waiting import PATIENCE, at_rest, until

if TYPE_CHECKING:
    from playwright.sync_api import FrameLocator, Page

# Of 255: what antialiasing does stays below it.
SEEN = 40
# Of a picture of some 500 x 300.
FEW, MANY = 20, 300
_HIDDEN = "<style>.mantine-Notifications-root, .mantine-Notification-root {display: none !important}</style>"


def without_overlays(page: Page) -> Page | FrameLocator:
    """What has the canvas, the page or its 3-D pane, from which notices over the picture are gone."""
    framed = page.locator("iframe.view").count() > 0
    inside = page.frame_locator("iframe.view") if framed else page
    inside.locator("body").evaluate("(body, style) => body.insertAdjacentHTML('beforeend', style)", _HIDDEN)
    return inside


def shot(page: Page) -> np.ndarray:
    """Picture of the canvas, the page's own or the 3-D pane's, without overlays (height, width, 3)."""
    inside = without_overlays(page)
    canvas = inside.locator("canvas").first
    # A picture of the element waits until its page's animations let it through, for which a busy machine has no time.
    data = page.screenshot(clip=canvas.bounding_box() or at_rest(canvas), timeout=1000 * PATIENCE)
    return np.asarray(import_module("PIL.Image").open(io.BytesIO(data)).convert("RGB")).astype(int)


def differing(a: np.ndarray, b: np.ndarray) -> int:
    """How many pixels do, of what both show: a line of words above a picture takes from its height."""
    height, width = min(a.shape[0], b.shape[0]), min(a.shape[1], b.shape[1])
    a, b = a[-height:, :width], b[-height:, :width]
    return int((np.abs(a - b).max(axis=2) > SEEN).sum())


def settled(page: Page) -> np.ndarray:
    """The picture once two looks at it agree."""
    looks = [shot(page)]

    def agree() -> bool:
        page.wait_for_timeout(250)
        looks.append(shot(page))
        return looks[-2].shape == looks[-1].shape and differing(looks[-2], looks[-1]) < FEW

    until(page, agree, "the picture does not come to rest")
    return looks[-1]


def changed(page: Page, before: np.ndarray, least: int = MANY) -> np.ndarray:
    """The picture once it differs from the one before, and has come to rest."""
    until(page, lambda: differing(shot(page), before) >= least, "the picture stays as it was")
    return settled(page)
