"""The viewer's server answers its own page only: other hosts, pages and tokens are refused, on sockets as well."""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial
from http.client import HTTPConnection
from importlib import import_module
from urllib.parse import urlsplit

import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import SymofrosError
from symofros.studio.viewer.page import viser_server
from symofros.studio.viewer.page.viewer_guard import ViewerGuard


@pytest.fixture(scope="module")
def viewer() -> Iterator[sf.Viewer]:
    with sf.Viewer(MODELS["pendulum"], port=0) as made:
        yield made


def status(viewer: sf.Viewer, path: str, **headers: str) -> tuple[int, bytes]:
    connection = HTTPConnection(viewer.host, viewer.port, timeout=60)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    assert answer.headers["Referrer-Policy"] == "no-referrer"
    return answer.status, answer.read()


def test_the_page_is_at_the_address_with_the_token(viewer: sf.Viewer) -> None:
    path = urlsplit(viewer.url).path
    assert len(path) > 20
    for host in (f"127.0.0.1:{viewer.port}", f"localhost:{viewer.port}", "localhost:9000"):  # The last: by a tunnel.
        code, page = status(viewer, path, Host=host)
        assert code == 200 and b"<title>pendulum - SYMOFROS</title>" in page and b"<title>Viser" not in page


def test_the_first_page_asks_for_the_preferred_colours() -> None:
    with sf.Viewer(MODELS["pendulum"], port=0) as viewer:
        path = urlsplit(viewer.url).path
        assert b'fetch("colours/"' in status(viewer, path)[1] and not viewer._dark
        assert status(viewer, "/colours/dark")[0] == 401 and not viewer._dark
        assert status(viewer, f"{path}colours/dark", Origin="https://evil.example")[0] == 403
        for first, then in (("dark", True), ("light", True)):  # Pages show the same: a later one does not ask.
            assert status(viewer, f"{path}colours/{first}") == (200, b"")
            end = time.monotonic() + 30.0
            while viewer._dark is not then:
                assert time.monotonic() < end
                time.sleep(0.01)
    with sf.Viewer(MODELS["pendulum"], port=0, controls=False) as viewer:  # The page around it says.
        assert b"colours/" not in status(viewer, urlsplit(viewer.url).path)[1]


def test_requests_without_token_or_from_other_hosts_get_no_page(viewer: sf.Viewer) -> None:
    own = urlsplit(viewer.url).path
    for path in ("/", own[:-2] + "/", "/index.html", "/wrong/", "/../"):
        code, page = status(viewer, path)
        assert code == 401 and b"Viser" not in page, path
        assert all(part in page for part in (b"token", b"found:", b"rule:", b"remedy:"))
    for headers in ({"Host": "evil.example"}, {"Origin": "https://evil.example"}, {"Origin": "null"}):
        code, page = status(viewer, own, **headers)
        assert code == 403 and b"Viser" not in page, headers


def test_the_socket_accepts_only_its_own_page(viewer: sf.Viewer) -> None:
    """The reproduction: a page of another origin read the scene, and moved it. Two may look at once."""
    connect = partial(
        import_module("websockets.sync.client").connect, subprotocols=[f"viser-v{import_module('viser').__version__}"]
    )
    address, own = f"ws://127.0.0.1:{viewer.port}", urlsplit(viewer.url).path
    evil = [(own, "https://evil.example"), (own, "http://127.0.0.1:1")]
    for path, origin in [("/", None), ("/wrong", None), *evil]:
        with pytest.raises(import_module("websockets.exceptions").InvalidStatus) as caught:
            connect(f"{address}{path}", origin=origin)
        assert caught.value.response.status_code == (403 if origin else 401)
    page = address.replace("ws", "http")
    with connect(f"{address}{own}", origin=None) as first, connect(f"{address}{own}", origin=page) as second:
        assert min(len(socket.recv(timeout=60)) for socket in (first, second)) > 100


@pytest.mark.parametrize(
    ("bound", "host", "allowed"),
    [
        ("127.0.0.1", "127.0.0.1:8080", True),
        ("127.0.0.1", "LOCALHOST", True),
        ("127.0.0.1", "[::1]:8080", True),
        ("127.0.0.1", "127.0.0.1.evil.example:8080", False),
        ("127.0.0.1", "[bad", False),
        ("127.0.0.1", "", False),
        ("::1", "[::1]:8080", True),
        ("127.0.0.2", "127.0.0.2:8080", True),
        ("0.0.0.0", "robot.lab:8080", True),
    ],
)
def test_only_names_of_this_machine_are_accepted_as_hosts(bound: str, host: str, allowed: bool) -> None:
    guard = ViewerGuard(bound, "secret")
    assert (guard.refusal("/secret/", [host], []) is None) is allowed
    assert guard.refusal("/secret/", [host, host], []) is not None
    assert guard.refusal("/secrets/", [host], []) is not None


def test_a_server_that_does_not_ask_is_not_left_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """As after a change of viser's inside."""
    viser, stopped = import_module("viser"), []

    class Unguarded:
        def __init__(self, **_: object) -> None:
            pass

        def stop(self) -> None:
            stopped.append(self)

    monkeypatch.setattr(viser, "ViserServer", Unguarded)
    with pytest.raises(SymofrosError, match="can't be guarded"):
        viser_server.start_server("127.0.0.1", 0, "secret")
    assert stopped
