"""Graphics: curves in a browser while a run goes on."""

from __future__ import annotations

import contextlib
import json
import secrets
import socket
import subprocess
import sys
import webbrowser
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.graphics.recorders import open_ports
from symofros.blocks.network.exchange import LOCALHOST, check_size
from symofros.blocks.network.packets import pack
from symofros.blocks.turns import Turn
from symofros.diagrams.block import Environment, Ports
from symofros.diagrams.external_block import ExternalBlock, Running
from symofros.diagrams.signals import entries
from symofros.errors import SymofrosError


@dataclass(frozen=True, kw_only=True)
class LivePlot(ExternalBlock):
    """Shows its inputs as curves in a browser while the run goes on.

    Another process draws; the loop only sends it a packet at each sample, and drops it where that would take time. The
    page stays until the program that ran the diagram ends.

    What it keeps of a run: "sent" and "dropped", how many samples.

    Attributes:
        signals: Names of its inputs.
        title: Title of the page; the block's name by default.
        window: Time span that is shown [s].
        open_browser: Whether to open a browser; the address is written to standard error either way.
    """

    signals: tuple[str, ...]
    title: str = ""
    window: float = 10.0
    open_browser: bool = True

    def ports(self, environment: Environment) -> Ports:
        """The signals."""
        ports = open_ports(self.name, self.signals, environment)
        check_size(self.name, max(1, sum(int(np.prod(port.shape)) for port in ports.inputs if port.shape is not None)))
        return ports

    def begin(self, environment: Environment) -> Running:
        """Start the page, or take over that of the run before.

        Raises:
            SymofrosError: The page's program does not start, or it shows a run that has not ended.
        """
        page: _Page = self.__dict__.setdefault("_page", _Page())
        page.turn.take(self.name)
        try:
            page.begin(self.name, self.open_browser)
        except BaseException:
            page.turn.leave()
            raise
        return _Showing(self, page)

    @property
    def url(self) -> str:
        """URL of the page of the last run; "" before the first."""
        page = self.__dict__.get("_page")
        return page.url if page else ""


class _Showing(Running):
    """One run on the page."""

    def __init__(self, block: LivePlot, page: _Page) -> None:
        self._block, self._page = block, page

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Hand over one sample."""
        block, page = self._block, self._page
        if page.sequence == 0:
            labels = [label for name in block.signals for label, _ in entries(name, inputs[name].shape)]
            page.say({"labels": labels, "title": block.title or block.name, "window": block.window, "done": False})
        page.send(t, np.concatenate([inputs[name].reshape(-1) for name in block.signals]))
        return {}

    def kept(self) -> Mapping[str, Array]:
        """Number of samples sent to the page, and number dropped."""
        page = self._page
        return {"sent": np.asarray(float(page.sequence - page.dropped)), "dropped": np.asarray(float(page.dropped))}

    def end(self) -> None:
        """Tell the page that the run has ended; it stays."""
        self._page.say({"done": True})
        self._page.turn.leave()


class _Page:
    """The other process, and the socket to it."""

    def __init__(self) -> None:
        self.turn = Turn()
        self.process: subprocess.Popen[str] | None = None
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setblocking(False)
        self.port, self.url = 0, ""
        self.stream = self.sequence = self.dropped = 0

    def begin(self, name: str, open_browser: bool) -> None:
        """Start the process unless it runs already; the samples of this run are a stream of their own."""
        self.stream, self.sequence, self.dropped = secrets.randbits(32), 0, 0
        if self.process is not None and self.process.poll() is None:
            return
        self.process = subprocess.Popen(
            [sys.executable, "-m", "symofros.blocks.graphics.live_page"],
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        if not line:
            raise SymofrosError(
                f"block '{name}': the page does not start",
                "its program ended",
                "python -m symofros.blocks.graphics.live_page serves it",
                "see what it wrote to standard error",
            )
        addresses = json.loads(line)
        self.port, self.url = addresses["udp"], addresses["url"]
        print(f"{name}: {self.url}", file=sys.stderr)
        if open_browser:
            webbrowser.open(self.url)

    def say(self, message: Mapping[str, Any]) -> None:
        """A line to the process, if it still listens."""
        assert self.process is not None and self.process.stdin is not None
        with contextlib.suppress(OSError):
            self.process.stdin.write(json.dumps(message) + "\n")
            self.process.stdin.flush()

    def send(self, t: float, values: Array) -> None:
        """One sample, or none."""
        try:
            self.socket.sendto(pack(self.stream, self.sequence, t, values), (LOCALHOST, self.port))
        except OSError:
            self.dropped += 1
        self.sequence += 1

    def close(self) -> None:
        """End the process."""
        self.socket.close()
        if self.process is not None and self.process.stdin is not None and self.process.stdout is not None:
            with contextlib.suppress(OSError):
                self.process.stdin.close()
            self.process.wait(5)
            self.process.stdout.close()

    def __del__(self) -> None:
        with contextlib.suppress(Exception):
            self.close()
