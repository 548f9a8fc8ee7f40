"""The guard refuses wrong hosts, foreign pages, wrong tokens and large requests; the server goes on."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from symofros.studio.editor.document.session import Session
from symofros.studio.editor.server.app import application
from symofros.studio.editor.server.guard import MAX_BODY, Guard
from tests.studio.editor.conftest import BASE, GRANTED, PORT, TOKEN
from tests.studio.editor.texts import TEXTS


def addresses(guard: Any) -> list[tuple[str, str]]:
    """Method and address of all that a page may ask for, without those of the picture (test_document_viewer.py)."""
    assert isinstance(guard, Guard)
    found = [
        (method, route.path.removeprefix("/api/").format(key="1", suffix="csv"))
        for route in guard.app.routes  # type: ignore[attr-defined]
        if not route.path.startswith("/view/")
        for method in (getattr(route, "methods", None) or set()) - {"HEAD"}
    ]
    assert len(found) >= 32 and {("GET", "document"), ("POST", "save"), ("DELETE", "jobs/1")} <= set(found)
    return found


def refused(client: TestClient, method: str, address: str, status: int, headers: dict[str, str]) -> None:
    answer = client.request(method, f"/api/{address}", headers=headers, json={} if method == "POST" else None)
    assert answer.status_code == status
    assert set(answer.json()["error"]) == {"object", "found", "rule", "remedy"}
    assert "access-control-allow-origin" not in answer.headers


@pytest.fixture
def bare(session: Session) -> Iterator[TestClient]:
    with TestClient(application(session, TOKEN, PORT), base_url=BASE) as found:
        yield found


def test_requests_without_the_token_are_refused(bare: TestClient, session: Session) -> None:
    wrong = ("Bearer no", TOKEN, f"Basic {TOKEN}", "Bearer ", f"Bearer {TOKEN}x")
    for method, address in addresses(bare.app):
        for headers in ({}, *({"Authorization": each} for each in wrong)):
            refused(bare, method, address, 401, headers)
        assert bare.get("/api/document", headers=GRANTED).status_code == 200
    assert session.document.text == TEXTS["four_bar"]


def test_a_foreign_page_is_refused_though_it_had_the_token(bare: TestClient) -> None:
    origins = ["https://evil.example", "http://127.0.0.1:1", "null"]
    origins += [f"https://127.0.0.1:{PORT}", f"http://localhost:{PORT}.evil.example"]
    foreign = [{"Origin": each} for each in origins]
    foreign += [{"Sec-Fetch-Site": f"{each}-site"} for each in ("cross", "same")]
    for method, address in addresses(bare.app):
        for headers in foreign:
            refused(bare, method, address, 403, {**GRANTED, **headers})
        assert bare.get("/api/document", headers=GRANTED).status_code == 200


def test_another_host_is_refused_also_for_the_page_itself(bare: TestClient) -> None:
    """A name of somebody else's that resolves to this machine (DNS rebinding); the own page is let in."""
    for host in ("evil.example", f"evil.example:{PORT}", "127.0.0.1", "127.0.0.1:1", f"[::1]:{PORT}", ""):
        refused(bare, "GET", "document", 403, {**GRANTED, "Host": host})
        refused(bare, "POST", "save", 403, {**GRANTED, "Host": host})
        assert bare.get("/", headers={"Host": host}).status_code == 403
    for host in (f"127.0.0.1:{PORT}", f"localhost:{PORT}", f"LOCALHOST:{PORT}"):
        origin = {"Host": host, "Origin": f"http://{host}", "Sec-Fetch-Site": "same-origin"}
        assert bare.get("/api/document", headers={**GRANTED, **origin}).status_code == 200
    assert bare.post("/", json={}, headers=GRANTED).status_code == 405  # Outside of the API one reads only.


def test_the_token_in_the_address_opens_events_only(bare: TestClient) -> None:
    assert bare.get(f"/api/document?token={TOKEN}").status_code == 401
    assert bare.post(f"/api/save?token={TOKEN}", json={}).status_code == 401
    assert bare.get("/api/events?token=wrong").status_code == 401


def test_forms_and_plain_text_cannot_post(bare: TestClient, session: Session) -> None:
    """What a page can send elsewhere without asking: forms and plain text."""
    for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data", ""):
        answer = bare.post("/api/discard", content=b"{}", headers={**GRANTED, "Content-Type": kind})
        assert answer.status_code == 415


def test_a_huge_body_is_refused_by_its_length_alone() -> None:
    """Nothing of it is read; nor of one whose length is none."""
    for length in (str(MAX_BODY + 1).encode(), b"-1", b"1e9", b"x", b"9" * 5000):
        assert _asked([(b"content-length", length)], lambda: pytest.fail("the body was read")) == 413


def test_a_body_without_a_length_is_cut_off_at_the_limit() -> None:
    chunk, given = b"x" * 65536, 0

    def endless() -> dict[str, Any]:
        nonlocal given
        given += len(chunk)
        return {"type": "http.request", "body": chunk, "more_body": True}

    assert _asked([], endless) == 413
    assert given <= MAX_BODY + 2 * len(chunk)


def _asked(headers: list[tuple[bytes, bytes]], receive: Any) -> int:
    """The status of a request whose body is handed over piece by piece."""
    import anyio
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import PlainTextResponse
    from starlette.routing import Route

    async def answer(request: Request) -> PlainTextResponse:
        return PlainTextResponse(str(len(await request.body())))

    app = Guard(Starlette(routes=[Route("/api/text", answer, methods=["POST"])]), TOKEN, PORT, "view")
    head = [
        (b"host", f"127.0.0.1:{PORT}".encode()),
        (b"authorization", f"Bearer {TOKEN}".encode()),
        (b"content-type", b"application/json"),
        *headers,
    ]
    scope = {
        "type": "http",
        "method": "POST",
        "path": "/api/text",
        "raw_path": b"/api/text",
        "query_string": b"",
        "headers": head,
        "http_version": "1.1",
        "scheme": "http",
        "server": ("127.0.0.1", PORT),
    }
    sent: list[dict[str, Any]] = []

    async def coming() -> Any:
        return receive()

    async def going(message: Any) -> None:
        sent.append(message)

    anyio.run(app, scope, coming, going)
    return int(sent[0]["status"])


def test_answers_carry_the_policies(client: TestClient) -> None:
    for address in ("/api/document", "/", "/nothing"):
        headers = client.get(address).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy and "script-src 'self';" in policy and "unsafe" not in policy
        assert headers["x-content-type-options"] == "nosniff" and headers["referrer-policy"] == "no-referrer"
    assert client.get("/api/document").headers["cache-control"] == "no-store"


def test_the_page_s_folder_is_not_left(client: TestClient) -> None:
    for path in ("/../app.py", "/%2e%2e/app.py", "/..%2fapp.py", "/assets/../../guard.py", "//etc/passwd"):
        answer = client.get(path)
        assert answer.status_code in (400, 404, 405) and b"import" not in answer.content, path


def test_malformed_bodies_are_refused_and_the_server_continues(client: TestClient, session: Session) -> None:
    for body in (b"", b"[]", b"{", b"3", b"[" * 200_000, b'{"revision": NaN, "text": "a"}', b"\xff", b"null"):
        answer = client.post("/api/text", content=body, headers={"Content-Type": "application/json"})
        assert answer.status_code in (409, 422) and "error" in answer.json(), body[:20]
    assert session.document.text == TEXTS["four_bar"]


HOSTILE = {
    "anchors": "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n",
    "deep": "a: " + "[" * 10_000,
    "tag": '!!python/object/apply:os.system ["touch MARK"]\n',
    "code": "symofros: 1\nbodies: {a: {inertia: {mass: \"__import__('os').system('touch MARK')\"}}}\n",
    "escape": 'a: "\\xZZ"',
    "nul": "a: \0",
    "merge": "a: {<<: {b: 1}}",
    "formula": "symofros: 1\nbodies: {a: {inertia: {mass: " + "(" * 5000 + "1" + ")" * 5000 + "}}}\n",
    "include": "symofros: 1\ninclude: [../../../../etc/passwd]\n",
}


@pytest.mark.parametrize("name", sorted(HOSTILE))
def test_hostile_texts_are_reported_and_not_executed(client: TestClient, tmp_path: Path, name: str) -> None:
    mark = tmp_path / "mark"
    answer = client.post("/api/text", json={"revision": 1, "text": HOSTILE[name].replace("MARK", str(mark))})
    assert answer.status_code == 200 and answer.json()["problems"]
    assert "root:" not in answer.text and not mark.exists()
    assert client.post("/api/undo", json={"revision": answer.json()["revision"]}).json()["problems"] == []


def test_hostile_formulas_are_refused(client: TestClient) -> None:
    texts = "__import__('os')", "().__class__", "L.__init__", "open('x')", "1e999", "(" * 999, "a" * 20_000, "9" * 9000
    fields = [{"path": path, "text": text} for text in texts for path in ([], ["bodies", "crank", "inertia", "mass"])]
    for found in client.post("/api/expression", json={"fields": fields}).json()["checks"]:
        assert not found["ok"] and found["error"]["rule"], found
