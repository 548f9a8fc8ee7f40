"""A program of its own: takes packets by UDP and shows them as curves in a browser, on this machine only.

`LivePlot` starts it. On its first line of standard output it says where it listens; on standard input it reads a line
that says what the values are, later one that the run has ended; when standard input closes, it ends.
"""

from __future__ import annotations

import hmac
import json
import secrets
import socket
import sys
import threading
import time
from collections import deque
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any

from symofros.blocks.network.packets import unpack

# Rows that a page which is opened late still sees.
ROWS = 20_000
# Interval at which new rows are sent to pages [s].
PAUSE = 0.05
# Rows in one message at most; of more, some are left out, evenly.
AT_ONCE = 500
_POLICY = "default-src 'self' 'unsafe-inline'; img-src data:; frame-ancestors 'none'"


class Feed:
    """Rows (t, values) as they arrive, numbered."""

    def __init__(self) -> None:
        self.head: dict[str, Any] = {}
        self.rows: deque[tuple[float, list[float]]] = deque(maxlen=ROWS)
        self.count = 0
        self.lock = threading.Lock()

    def take(self, data: bytes) -> None:
        """Append the row of one datagram; data that is not a packet of the run is dropped."""
        packet = unpack(data, len(self.head.get("labels", ())))
        if packet is not None:
            with self.lock:
                self.rows.append((packet.t, packet.values.tolist()))
                self.count += 1

    def since(self, seen: int) -> tuple[int, list[tuple[float, list[float]]]]:
        """Total number of rows so far, and the rows after the first `seen`, thinned to at most AT_ONCE."""
        with self.lock:
            new = min(self.count - seen, len(self.rows))
            rows = [self.rows[i] for i in range(len(self.rows) - new, len(self.rows))]
        return self.count, rows[:: -(-len(rows) // AT_ONCE) or 1]


class Page(BaseHTTPRequestHandler):
    """Answers the browser: the page, and its stream of rows."""

    feed: Feed
    token: str
    port: int

    def do_GET(self) -> None:
        """Serve the page at /TOKEN/ and its rows at /TOKEN/rows; refuse other paths, hosts and origins."""
        hosts = (f"127.0.0.1:{self.port}", f"localhost:{self.port}")
        first, _, rest = self.path.removeprefix("/").partition("/")
        foreign = {*self.headers.get_all("Origin", [])} - {f"http://{host}" for host in hosts}
        is_own = not foreign and self.headers.get("Host") in hosts
        if not is_own or not hmac.compare_digest(first.encode(), self.token.encode()):
            self.send_error(403)
        elif rest == "":
            self._send("text/html; charset=utf-8", (files("symofros.blocks.graphics") / "live_page.html").read_bytes())
        elif rest == "rows":
            self._stream()
        else:
            self.send_error(404)

    def _begin(self, kind: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", _POLICY)

    def _send(self, kind: str, data: bytes) -> None:
        self._begin(kind)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def _stream(self) -> None:
        """Stream events until the page closes: the head whenever it changes, and new rows."""
        self._begin("text/event-stream")
        self.end_headers()
        seen, sent_head = 0, None
        try:
            while True:
                message: dict[str, Any] = {}
                if sent_head != self.feed.head:
                    message["head"] = sent_head = dict(self.feed.head)
                seen, rows = self.feed.since(seen)
                if rows or message:
                    message["rows"] = rows
                    self.wfile.write(f"data: {json.dumps(message)}\n\n".encode())
                    self.wfile.flush()
                time.sleep(PAUSE)
        except OSError:  # The page was closed.
            return

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing: standard output belongs to the one who started this."""


def main() -> None:
    """Serve until standard input closes."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.bind(("127.0.0.1", 0))
    Page.feed, Page.token = Feed(), secrets.token_urlsafe(16)
    server = ThreadingHTTPServer(("127.0.0.1", 0), Page)
    server.daemon_threads = True
    Page.port = server.server_address[1]
    threading.Thread(target=server.serve_forever, daemon=True).start()
    threading.Thread(target=_listen, args=(listener, Page.feed), daemon=True).start()
    url = f"http://127.0.0.1:{Page.port}/{Page.token}/"
    print(json.dumps({"udp": listener.getsockname()[1], "url": url}), flush=True)
    for line in sys.stdin:
        Page.feed.head |= json.loads(line)


def _listen(listener: socket.socket, feed: Feed) -> None:
    while True:
        feed.take(listener.recv(65536))


if __name__ == "__main__":
    main()
