"""The 3-D pane as tests see it: its picture, and when that has come to rest."""

from __future__ import annotations

import io
import time

import numpy as np
from PIL import Image
from playwright.sync_api import Page

from tests.studio.editor.browser import steps

PATIENCE = 60.0  # Software rendering on a busy machine.
# Of 255: what antialiasing does stays below it.
SEEN = 40
# Of a picture of some 500 x 300.
FEW, MANY = 20, 300


def shot(page: Page) -> np.ndarray:
    """What the frame shows, without what floats over the picture (height, width, 3)."""
    frame = page.frame_locator("iframe.view")
    return np.asarray(
        Image.open(io.BytesIO(frame.locator("canvas").first.screenshot(timeout=1000 * PATIENCE))).convert("RGB")
    ).astype(int)


def differing(a: np.ndarray, b: np.ndarray) -> int:
    """How many pixels do."""
    assert a.shape == b.shape
    return int((np.abs(a - b).max(axis=2) > SEEN).sum())


def settled(page: Page) -> np.ndarray:
    """The picture once two looks at it agree."""
    end, before = time.monotonic() + PATIENCE, shot(page)
    while time.monotonic() < end:
        page.wait_for_timeout(250)
        after = shot(page)
        if before.shape == after.shape and differing(before, after) < FEW:
            return after
        before = after
    raise AssertionError("the picture does not come to rest")


def changed(page: Page, before: np.ndarray, least: int = MANY) -> np.ndarray:
    """The picture once it differs from the one before, and has come to rest."""
    end = time.monotonic() + PATIENCE
    while differing(shot(page), before) < least:
        assert time.monotonic() < end, "the picture stays as it was"
        page.wait_for_timeout(100)
    return settled(page)


def open_view(page: Page) -> np.ndarray:
    """Open the pane, and wait until the mechanism is drawn."""
    steps.run(page, "3-D")
    page.frame_locator("iframe.view").locator("canvas").first.wait_for(timeout=1000 * PATIENCE)
    end = time.monotonic() + PATIENCE
    while (shot(page) < 200).any(axis=2).sum() < MANY:
        assert time.monotonic() < end, "nothing is drawn"
        page.wait_for_timeout(250)
    return settled(page)
