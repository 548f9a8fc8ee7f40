"""The page that shows a run while it goes on."""

from __future__ import annotations

import json
import socket
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import LivePlot
from symofros.blocks.graphics.live_page import AT_ONCE, ROWS, Feed
from symofros.blocks.network.packets import pack
from tests.diagrams.parts import ramp


@pytest.fixture(scope="module")
def shown() -> Iterator[LivePlot]:
    d = sf.Diagram("live")
    d.add(ramp())
    live = LivePlot(name="live", signals=("a", "b"), title="A <b>run</b>", period=0.01, open_browser=False)
    d.add(live, a="ramp.y", b="ramp.y")
    run = sf.Simulation(d).run(0.5, dt=1e-2, realtime=True)
    assert run.kept["live"]["sent"] == 51 and run.kept["live"]["dropped"] == 0
    yield live
    live.__dict__["_page"].close()


def received(shown: LivePlot) -> tuple[dict[str, Any], list[Any]]:
    """What the page knows of the run and its rows, once it knows that the run is over."""
    head: dict[str, Any] = {}
    rows: list[Any] = []
    with urllib.request.urlopen(shown.url + "rows", timeout=60) as stream:
        for line in stream:
            if line.startswith(b"data: "):
                message = json.loads(line.decode().removeprefix("data: "))
                head, rows = message.get("head", head), rows + message["rows"]
                if head.get("done"):
                    break
    return head, rows


def test_the_page_receives_the_samples_sent(shown: LivePlot) -> None:
    head, rows = received(shown)
    assert head["labels"] == ["a[0]", "a[1]", "b[0]", "b[1]"] and head["title"] == "A <b>run</b>" and head["done"]
    # What was sent before the page's program knew what it is, is not shown.
    assert len(rows) > 40 and rows[-1] == [0.5, [0.5, 1.0, 0.5, 1.0]]
    with urllib.request.urlopen(shown.url, timeout=60) as page:
        text = page.read().decode()
        assert "EventSource" in text and "frame-ancestors 'none'" in page.headers["Content-Security-Policy"]


def test_requests_of_other_paths_hosts_or_origins_are_refused(shown: LivePlot) -> None:
    root = shown.url.rsplit("/", 2)[0]
    for path in ("/", "/guess/", "/guess/rows", "/favicon.ico"):
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(root + path, timeout=60)
    for headers in ({"Host": "evil.example"}, {"Origin": "http://evil.example"}, {"Origin": "null"}):
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(urllib.request.Request(shown.url, headers=headers), timeout=60)
    with pytest.raises(urllib.error.HTTPError, match="404"):
        urllib.request.urlopen(shown.url + "other", timeout=60)


def test_invalid_packets_of_other_senders_are_dropped(shown: LivePlot) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        for data in (b"", b"SYMO", pack(1, 1, 9.0, np.zeros(3)), pack(1, 1, 9.0, np.full(4, np.nan))):
            other.sendto(data, ("127.0.0.1", shown.__dict__["_page"].port))
    assert received(shown)[1][-1][0] == 0.5


def test_rows_are_bounded_and_thinned() -> None:
    feed = Feed()
    feed.head = {"labels": ["x"]}
    for i in range(ROWS + 100):
        feed.take(pack(1, i, float(i), np.array([1.0])))
    seen, rows = feed.since(0)
    assert seen == ROWS + 100 and rows[0][0] == 100.0 and 0.9 * AT_ONCE < len(rows) <= AT_ONCE
    assert feed.since(seen) == (seen, []) and len(feed.since(seen - 3)[1]) == 3
