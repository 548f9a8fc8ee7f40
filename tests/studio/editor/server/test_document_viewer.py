"""The 3-D view behind the guard: what it says, how it moves, who is refused."""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as parquet
import pytest
from PIL import Image
from starlette.testclient import TestClient, WebSocketTestSession
from starlette.websockets import WebSocketDisconnect

import symofros as sf
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.server.app import Editor, application
from symofros.studio.editor.server.document_viewer import DocumentViewer
from symofros.studio.editor.server.relay import MAX_SOCKETS
from tests.late import require
from tests.studio.editor.conftest import BASE, PORT, TOKEN, finished, look, pose
from tests.studio.editor.texts import FILES

Json = dict[str, Any]
PROTOCOL = "viser-v1.1.1"
JSON = {"Content-Type": "application/json"}
OWN = f"127.0.0.1:{PORT}"


def socket_at(client: TestClient, path: str, origin: str | None = BASE, **headers: str) -> WebSocketTestSession:
    given = headers if origin is None else {"Origin": origin, **headers}
    return client.websocket_connect(f"ws://127.0.0.1:{PORT}{path}", [PROTOCOL], headers=given)


def edit(client: TestClient, *path: str | int, value: Any) -> None:
    revision = client.get("/api/document").json()["revision"]
    edits = [{"op": "set", "path": list(path), "value": value}]
    answer = client.post("/api/edit", json={"revision": revision, "label": "edit", "edits": edits})
    assert answer.status_code == 200, answer.text


def test_a_pose_lists_the_bending_of_its_beams(client: TestClient, folder: Path) -> None:
    shutil.copy(FILES["double_pendulum"].parents[1] / "flexible" / "flexible_pendulum.yaml", folder)
    assert client.post("/api/open", json={"path": "flexible_pendulum.yaml"}).status_code == 200
    (straight,) = look(client)["beams"]
    assert straight["grade"] == "fine" and straight["error"] == 0.0
    (bent,) = pose(client, q={"rod.bend_z[0]": 0.3}, exaggeration=20)["beams"]
    assert bent["beam"] == "rod" and bent["grade"] != "fine" and bent["slope"] > 0.1 and bent["t"] is None
    assert pose(client, reset=True)["beams"] == [straight]


def test_loops_close_around_the_moved_coordinate(client: TestClient) -> None:
    view = look(client)
    assert view["address"].startswith("/view/") and TOKEN not in view["address"]
    assert view["fault"] is None and not view["flexible"]
    assert all(one["low"] < one["high"] and one["unit"] == "rad" for one in view["coordinates"])
    assert set(view["q"]) == {one["name"] for one in view["coordinates"]}
    name = view["coordinates"][0]["name"]
    found = pose(client, q={name: view["q"][name] + 0.3})
    assert found["q"][name] == pytest.approx(view["q"][name] + 0.3, abs=1e-12)
    assert found["why"] == "" and found["gap"] < 1e-9
    assert all(abs(found["q"][other] - view["q"][other]) > 1e-3 for other in found["q"])
    assert pose(client, reset=True)["q"] == pytest.approx(view["q"])


@pytest.fixture
def crank(client: TestClient, folder: Path) -> TestClient:
    """A document with a slider-crank open."""
    shutil.copy(FILES["slider_crank"], folder)
    assert client.post("/api/open", json={"path": "slider_crank.yaml"}).status_code == 200
    return client


def test_a_parameter_moves_it_before_the_document_changes(crank: TestClient) -> None:
    view = look(crank)
    assert [one["unit"] for one in view["coordinates"]] == ["rad", "rad", "m"] and "L1" in view["run_time"]
    found = pose(crank, q={"turn": 0.0, "swing": 0.0}, par={"L1": 0.2})
    assert found["why"] == "" and found["gap"] < 1e-9
    assert found["q"]["slide"] == pytest.approx(0.2 + 0.3)
    assert crank.get("/api/document").json()["dirty"] is False


@pytest.mark.parametrize(("ground", "gap"), [("0.7*L", 0.0), ("5*L", 4.0)], ids=["closes", "out of reach"])
def test_a_loop_just_drawn_is_shown_closed_or_with_its_gap(client: TestClient, ground: str, gap: float) -> None:
    """A four-bar whose links lie in one line, at a distance of its pivots."""
    text = client.get("/api/document").json()["text"]
    text = text.replace("position: [L, 0, 0], axis", f"position: [{ground}, 0, 0], axis")
    assert client.post("/api/text", json={"revision": 1, "text": text}).status_code == 200
    view = look(client)
    assert view["gap"] == pytest.approx(gap, abs=1e-9) and (view["gap_unit"] == "m" or not gap)
    assert any(abs(value) > 0.1 for value in view["q"].values()) or gap


def test_the_view_stays_where_loops_cannot_be_closed(crank: TestClient) -> None:
    view = look(crank)
    found = pose(crank, q={"turn": 1.57}, par={"L2": 0.1})  # The crank's end is 0.15 m above the slider's axis.
    assert found["why"] and found["q"] == view["q"] and found["gap"] < 1e-9
    assert pose(crank, q={"turn": 1.57})["why"] == ""  # The rod is as long as it was.


def test_the_view_follows_the_document_and_keeps_the_last_valid_model(client: TestClient) -> None:
    first = look(client)
    moved = pose(client, q={first["coordinates"][0]["name"]: first["q"][first["coordinates"][0]["name"]] + 0.2})
    edit(client, "bodies", "crank", "inertia", "mass", value="nobody")
    broken = look(client)
    assert broken["fault"]["object"] == "the model has problems" and broken["q"] == moved["q"]
    edit(client, "bodies", "crank", "inertia", "mass", value=2.0)
    mended = look(client)
    assert mended["fault"] is None and mended["q"] == pytest.approx(moved["q"])
    client.post("/api/open", json={"path": "double_pendulum.yaml"})
    assert set(look(client)["q"]) != set(first["q"])


def test_a_model_that_was_never_valid_has_no_view(client: TestClient) -> None:
    edit(client, "bodies", "crank", "inertia", "mass", value="nobody")
    answer = client.get("/api/view")
    assert answer.status_code == 422 and answer.json()["error"]["object"] == "the model has problems"
    assert client.post("/api/pose", json={"q": {}}).json()["error"]["object"] == "nothing is shown"


def test_odd_poses_are_refused(client: TestClient) -> None:
    before = look(client)["q"]
    bodies: list[Json] = [{"q": q} for q in (3, {"nobody": 1.0}, {"a": "1"}, {"a": 10**400}, {"a": True})]
    bodies += [{"par": {"nobody": 1.0}}, {"par": [1.0]}, {"marked": "bodies/crank"}, {"marked": [1]}]
    for body in (*bodies, {"exaggeration": 1e9}, {"exaggeration": "2"}):
        answer = client.post("/api/pose", json=body)
        assert answer.status_code == 422 and set(answer.json()["error"]) == {"object", "found", "rule", "remedy"}, body
    assert look(client)["q"] == before


@pytest.fixture
def bare(session: Session) -> Iterator[TestClient]:
    """A client without a token of its own."""
    with TestClient(application(session, TOKEN, PORT), base_url=BASE) as found:
        yield found


@pytest.fixture
def address(bare: TestClient) -> str:
    answer = bare.get("/api/view", headers={"Authorization": f"Bearer {TOKEN}"})
    found: str = answer.json()["address"]
    return found


def test_the_view_page_is_isolated_from_the_editor_page(bare: TestClient, address: str) -> None:
    answer = bare.get(address)
    assert answer.status_code == 200 and b"<title>" in answer.content and b"<title>Viser</title>" not in answer.content
    policies = [value for name, value in answer.headers.multi_items() if name == "content-security-policy"]
    assert len(policies) == 1
    assert policies[0].startswith("sandbox allow-scripts; default-src 'none';") and "allow-same" not in policies[0]
    assert f"frame-ancestors http://127.0.0.1:{PORT} http://localhost:{PORT}" in policies[0]
    assert answer.headers["cache-control"] == "no-store"


def test_the_view_page_needs_its_own_token(bare: TestClient, address: str) -> None:
    others = (f"/view/{end}" for end in ("", "wrong/", "../view/wrong/", f"{TOKEN}/"))
    for path in (*others, address[:-2] + "/", address + "more", address[:-1] + "x/"):
        answer = bare.get(path)
        assert answer.status_code == 401 and b"Viser" not in answer.content
    assert bare.get(f"{address}page/99").status_code == 422  # A page that simulates, of a run that there is not.
    assert bare.get("/view/wrong/page/99").status_code == 401


def test_the_view_token_opens_nothing_else(bare: TestClient, address: str) -> None:
    token = address.split("/")[2]
    for path in ("document", "view", f"events?token={token}"):
        assert bare.get(f"/api/{path}", headers={"Authorization": f"Bearer {token}"}).status_code == 401
    assert bare.post("/api/pose", json={}, headers={"Authorization": f"Bearer {token}"}).status_code == 401


def test_the_view_page_accepts_only_requests_of_the_editor(bare: TestClient, address: str) -> None:
    foreign = [{"Host": host} for host in ("evil.example", f"evil.example:{PORT}")]
    for headers in (*foreign, {"Sec-Fetch-Site": "cross-site"}, {"Origin": "https://evil.example"}):
        assert bare.get(address, headers=headers).status_code == 403, headers


def test_the_view_socket_needs_its_address(bare: TestClient, address: str) -> None:
    """And hands on what the viewer says, to more in turn than may be open at once."""
    own = address[:-1]
    refused = [(own, origin, OWN) for origin in ("https://evil.example", "http://127.0.0.1:1", None)]
    refused += [(own, BASE, "evil.example"), (own, "null", f"evil.example:{PORT}")]
    refused += [(address[:-2], BASE, OWN), (address[:-2], "null", OWN), (address[:6], BASE, OWN)]
    for path, origin, host in refused:
        with pytest.raises(WebSocketDisconnect), socket_at(bare, path, origin, Host=host):
            pytest.fail(f"{path} {origin} {host}")
    for path in ("/", "/api/events", "/api/document"):  # There are no other sockets.
        with pytest.raises(WebSocketDisconnect), socket_at(bare, path, Authorization=f"Bearer {TOKEN}"):
            pytest.fail(path)
    for k in range(MAX_SOCKETS + 2):
        with socket_at(bare, own, "null" if k % 2 else BASE) as socket:
            assert socket.accepted_subprotocol == PROTOCOL
            assert len(socket.receive_bytes()) > 100


def test_a_run_is_shown_at_a_time_and_kept_as_a_file(client: TestClient, folder: Path) -> None:
    job = finished(client, "simulate", t_end=0.2, points=20, q0={"q1": 1.2, "q2": -1.2, "q3": 1.2})
    run, series = job["id"], {item["name"]: item["values"] for item in job["result"]["series"]}
    assert client.post("/api/pose", json={"run": run, "t": 0.1}).status_code == 422  # Nothing is shown yet.
    look(client)
    for t, i in ((-1, 0), (0.1, 10), (5, 20)):
        shown = pose(client, run=run, t=t)["q"]
        assert shown["q1"] == pytest.approx(series["q1"][i], abs=1e-6)
    for body in ({"run": run, "t": "soon"}, {"run": run, "t": float("inf")}, {"run": "99", "t": 0}):
        content = json.dumps(body)
        assert client.post("/api/pose", content=content, headers=JSON).status_code == 422

    # The same columns as a trajectory's file, which the viewer reads.
    file = folder / "run.csv"
    for suffix in ("csv", "parquet"):
        answer = client.get(f"/api/jobs/{run}/table.{suffix}")
        assert answer.status_code == 200
        file.with_suffix(f".{suffix}").write_bytes(answer.content)
    head, *rows = file.read_text().splitlines()
    assert head.startswith("t,q1,q2,") and len(rows) == 21
    table = parquet.read_table(file.with_suffix(".parquet"))
    assert table["q1"].to_pylist() == series["q1"] and table.schema.field("q1").metadata == {b"unit": b"rad"}
    assert client.get(f"/api/jobs/{run}/table.exe").status_code == 422

    # A film of it, at half its speed: 0.2 s in 9 pictures, twenty a second.
    film = client.get(f"/api/jobs/{run}/film.gif?speed=0.5&exaggeration=5")
    assert film.status_code == 200 and film.headers["content-type"] == "image/gif"
    with Image.open(io.BytesIO(film.content)) as gif:
        assert gif.n_frames == 9 and gif.info["duration"] == 50
    for asked in ("exe", "gif?speed=0", "gif?speed=soon", "gif?speed=0.001", "gif?exaggeration=nan"):
        assert client.get(f"/api/jobs/{run}/film.{asked}").status_code == 422

    # Frames are seen through the bodies that they are in.
    assert not pose(client, t=0, run=run)["frames"] and pose(client, frames=True)["frames"]

    # Of another mechanism it can't be shown.
    edit(client, "bodies", "crank", "joint", "name", value="angle")
    look(client)
    refused = client.post("/api/pose", json={"run": run, "t": 0})
    assert refused.status_code == 422 and "does not fit" in refused.json()["error"]["object"]
    outdated = client.get(f"/api/jobs/{run}/film.gif")
    assert outdated.status_code == 422 and "has changed since" in outdated.json()["error"]["object"]


@pytest.mark.parametrize("before", [False, True])
def test_a_film_is_refused_where_somebody_changes_the_document_between_two_steps_of_a_request(
    client: TestClient, session: Session, monkeypatch: pytest.MonkeyPatch, before: bool
) -> None:
    alone = Editor.exclusively

    async def overtaken(editor: Editor, work: Callable[[], Any]) -> Any:
        session.document.revision += before
        result = await alone(editor, work)
        session.document.revision += not before
        return result

    if before:  # As the film is asked for.
        run = finished(client, "simulate", t_end=0.1, points=3)["id"]
        monkeypatch.setattr(Editor, "exclusively", overtaken)
    else:  # As the run begins.
        with monkeypatch.context() as patched:
            patched.setattr(Editor, "exclusively", overtaken)
            run = finished(client, "simulate", t_end=0.1, points=3)["id"]
    outdated = client.get(f"/api/jobs/{run}/film.gif")
    assert outdated.status_code == 422 and "has changed since" in outdated.json()["error"]["object"]


@pytest.mark.slow  # In every run: that its address needs the view's token.
def test_the_page_is_kept_apart_and_its_address_has_a_token_of_its_own(client: TestClient) -> None:
    """A page that simulates by itself: the job that makes it, its address, what it may do."""
    require("ziglang", "zig")
    job = finished(client, "page", 300.0, q0={"q1": 1.2}, v0={"q1": 0.5}, method="rk4", dt=1e-3)
    assert job["state"] == "done" and set(job["result"]) == {"address", "notes"}
    address = job["result"]["address"]
    assert address.startswith("/view/") and TOKEN not in address
    page = client.get(address, headers={"Authorization": ""})
    assert page.status_code == 200 and "WebAssembly.instantiate" in page.text
    policy = page.headers["content-security-policy"]
    assert policy.startswith("sandbox allow-scripts; default-src 'none'")
    assert page.headers["cache-control"] == "no-store"
    known = address.split("/")[2]
    assert client.get(address.replace(known, "x" * len(known))).status_code == 401
    assert client.get(f"/view/{known}/page/99").status_code == 422
    assert client.get(f"{address}/more").status_code == 401
    wrong = finished(client, "page", method="cvode")
    assert wrong["state"] == "failed" and "cvode" in wrong["error"]["object"]


def test_a_frame_is_dragged_and_pages_get_the_posture() -> None:
    """The loop stays closed, all of it moves; an unknown frame is refused."""
    reported: list[tuple[str, Json]] = []
    view = DocumentViewer(lambda kind, data: reported.append((kind, data)))
    try:
        view.follow(sf.load(FILES["four_bar"]))
        before = view.pose({"drag": "crank.end"})["q"]
        viewer = view._viewer
        assert viewer is not None and viewer._handle is not None
        place = np.asarray(viewer._handle.node.position)
        viewer._handle.node.position = place + [0.05, 0.0, -0.1]
        viewer._dragged(False)
        kind, posed = reported[-1]
        assert kind == "posed" and posed["gap"] < 1e-9 and posed["why"] == ""
        assert all(abs(posed["q"][name] - before[name]) > 1e-3 for name in before)
        with pytest.raises(EditError, match="nose"):
            view.pose({"drag": "nose"})
        view.pose({"drag": ""})
        assert viewer._handle is None
    finally:
        view.close()
