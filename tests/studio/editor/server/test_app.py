"""The addresses: what a page sends, and what it gets."""

from __future__ import annotations

import asyncio
import math
import threading
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from starlette.requests import Request
from starlette.responses import StreamingResponse
from starlette.testclient import TestClient

from symofros.simulation.stepping.methods import METHODS
from symofros.studio.editor.document import session as session_module
from symofros.studio.editor.document.analysis import analyse
from symofros.studio.editor.document.parts.palette import PALETTE
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.editing.data_edits import Edit
from symofros.studio.editor.editing.yaml_edits import apply
from symofros.studio.editor.server.app import Editor, application
from tests.studio.editor.conftest import BASE, GRANTED, PORT, TOKEN
from tests.studio.editor.texts import FILES, TEXTS

KEYS = set(
    "path trail diagram name revision dirty step can_undo can_redo undo_label redo_label text data layout"
    " graph problems parameters inputs recovered disk_changed unkept lines".split()
)


def test_a_document_has_the_fields_of_the_contract(client: TestClient) -> None:
    found = client.get("/api/document").json()
    assert set(found) == KEYS
    assert found["path"] == "four_bar.yaml" and found["text"] == TEXTS["four_bar"]
    mass = {"name": "m", "value": 1.0, "unit": "kg", "constant": False, "number": 1.0, "unit_fault": ""}
    assert found["parameters"][0] == mass


def test_edit_undo_redo_and_save_change_the_document(client: TestClient, folder: Path) -> None:
    edit = {"op": "set", "path": ["parameters", "m", "value"], "value": 3}
    first = client.post("/api/edit", json={"revision": 1, "label": "mass", "edits": [edit]}).json()
    assert first["dirty"] and first["undo_label"] == "mass" and first["data"]["parameters"]["m"]["value"] == 3
    stale = client.post("/api/edit", json={"revision": 1, "label": "mass", "edits": [edit]})
    assert stale.status_code == 409 and stale.json()["document"]["revision"] == first["revision"]
    undone = client.post("/api/undo", json={"revision": first["revision"]}).json()
    assert undone["text"] == TEXTS["four_bar"] and undone["can_redo"]
    redone = client.post("/api/redo", json={"revision": undone["revision"]}).json()
    saved = client.post("/api/save", json={"revision": redone["revision"]}).json()
    assert not saved["dirty"] and (folder / "four_bar.yaml").read_text() == saved["text"]


def test_meaningless_edits_and_edits_of_invalid_yaml_are_refused(client: TestClient) -> None:
    edit = {"op": "remove", "path": ["bodies", "nobody"]}
    answer = client.post("/api/edit", json={"revision": 1, "edits": [edit]})
    assert answer.status_code == 422 and answer.json()["error"]["found"] == "no 'nobody'"
    broken = client.post("/api/text", json={"revision": 1, "text": "a: ]"}).json()
    assert broken["text"] == "a: ]" and len(broken["graph"]["nodes"]) == 4  # The last diagram stays.
    edit = {"op": "set", "path": ["a"], "value": 1}
    answer = client.post("/api/edit", json={"revision": broken["revision"], "edits": [edit]})
    assert answer.status_code == 422 and "not YAML" in answer.json()["error"]["object"]


def test_a_conflict_on_disk_carries_both_texts(client: TestClient, folder: Path) -> None:
    changed = client.post("/api/text", json={"revision": 1, "text": TEXTS["four_bar"] + "# ours\n"}).json()
    (folder / "four_bar.yaml").write_text("# theirs\n")
    answer = client.post("/api/save", json={"revision": changed["revision"]})
    found = answer.json()
    assert answer.status_code == 409 and found["disk"] == "# theirs\n" and found["text"].endswith("# ours\n")
    saved = client.post("/api/save", json={"revision": changed["revision"], "over": found["over"]})
    assert saved.status_code == 200 and (folder / "four_bar.yaml").read_text().endswith("# ours\n")


def test_examples_are_listed_and_begin_a_document(client: TestClient, folder: Path) -> None:
    names = [each["name"] for each in client.get("/api/examples").json()["examples"]]
    assert "balance" in names
    begun = client.post("/api/example", json={"name": "balance"}).json()
    assert begun["name"] == "balance.yaml" and begun["dirty"] and begun["problems"] == []
    assert (folder / "rigid/cart_pole.yaml").is_file()
    grouped = client.post(
        "/api/group", json={"revision": begun["revision"], "name": "law", "blocks": ["blocks/lqr"]}
    ).json()
    assert grouped["data"]["parts"]["law"]["file"] == "law.yaml" and grouped["undo_label"] == "group into law"
    assert client.post("/api/example", json={"name": "nothing"}).status_code == 422
    assert (
        client.post("/api/group", json={"revision": grouped["revision"], "name": "x", "blocks": 3}).status_code == 422
    )


def test_a_page_that_begins_to_listen_hears_how_the_document_stands(session: Session) -> None:
    """It may have changed between the page's first request and this one."""

    async def scene() -> list[str]:
        editor = Editor(session, "")
        session.edit({"revision": 1, "edits": [{"op": "set", "path": ["parameters", "L", "value"], "value": 2}]})
        editor.jobs.warm = lambda: None  # type: ignore[method-assign]
        answer = await editor.listen(Request({"type": "http"}))
        assert isinstance(answer, StreamingResponse)
        stream = aiter(answer.body_iterator)
        return [str(await anext(stream)) for _ in range(2)]

    assert asyncio.run(scene())[1] == 'event: document\ndata: {"revision": 2, "name": "four_bar.yaml"}\n\n'


def test_files_are_listed_opened_and_created(client: TestClient, folder: Path) -> None:
    assert [f["path"] for f in client.get("/api/files").json()["files"]] == ["double_pendulum.yaml", "four_bar.yaml"]
    assert client.post("/api/open", json={"path": "double_pendulum.yaml"}).json()["name"] == "double_pendulum.yaml"
    assert client.post("/api/open", json={"path": "../x.yaml"}).status_code == 422
    made = client.post("/api/new", json={"path": "robot.yaml"}).json()
    assert made["dirty"] and made["data"]["system"]["name"] == "robot" and not (folder / "robot.yaml").exists()
    assert client.post("/api/new", json={"path": "four_bar.yaml"}).status_code == 422


def test_a_double_pendulum_can_be_drawn_from_nothing(client: TestClient) -> None:
    """As the page does it: templates from the palette, wired by edits; no problem is left at the end."""
    palette = {part["kind"]: part["template"] for part in client.get("/api/schema").json()["palette"]}
    document = client.post("/api/new", json={"path": "drawn.yaml"}).json()
    assert any("nothing moves" in problem["object"] for problem in document["problems"])
    for name, parent in (("upper", {}), ("lower", {"parent": "upper", "frame": "tip"})):
        template = palette["rigid_body"]
        body = {**template, "joint": {**template["joint"], **parent}}
        edit = {"op": "insert", "path": ["bodies"], "key": name, "value": body}
        document = client.post("/api/edit", json={"revision": document["revision"], "edits": [edit]}).json()
    assert document["problems"] == []
    joints = [(edge["source"], edge["source_port"], edge["target"]) for edge in document["graph"]["edges"]]
    assert joints == [("world", "", "bodies/upper"), ("bodies/upper", "tip", "bodies/lower")]


def test_every_template_of_the_palette_is_valid_as_it_stands(client: TestClient) -> None:
    catalogue = client.get("/api/schema").json()
    assert [method["name"] for method in catalogue["methods"]] == list(METHODS)
    assert {"kg", "N m"} <= set(catalogue["units"]) and {"c", "fmu3"} <= set(catalogue["targets"])
    schema = Draft202012Validator(catalogue["schema"])
    # On the world alone, a massless body has nothing to carry, and constraints nothing to hold.
    own = {"massless_body", "closure", "rod", "connection", "contact", "nonholonomic"}
    for part in PALETTE:
        path = (part["section"], part["name"])
        found = analyse(FILES["double_pendulum"], apply(TEXTS["double_pendulum"], Edit("set", path, part["template"])))
        assert all(tuple(problem["path"][:2]) == path and part["kind"] in own for problem in found.problems), path
        assert not list(schema.iter_errors(found.data)), path


MASS = ["bodies", "crank", "inertia", "mass"]
# Path and text of a field -> what is answered: of a formula that is good, or where another one is not, and why.
FIELDS: list[tuple[list[str | int], str, dict[str, object]]] = [
    ([], "2*(1+2)", {"ok": True, "names": [], "value": 6.0}),
    ([], "2*q1 - L", {"ok": True, "names": ["L", "q1"]}),
    (MASS, "2*L + pi", {"ok": True, "names": ["L"], "value": 2 + math.pi}),
    (["bodies", "crank", "inertia", "center_of_mass", 0], "L", {"ok": True, "names": ["L"], "value": 1.0}),
    ([], "2*L +", {"column": 6, "found": "too early"}),
    ([], "2 L", {"column": 3, "found": "unexpected"}),
    ([], "1/(2-2)", {"column": 0, "found": "divi"}),
    (MASS, "2*K", {"column": 3, "found": "unknown symbol 'K'"}),
    (MASS, "q1", {"column": 1, "found": "may not be used"}),
    (["bodies", "crank", "joint", "axis", 0], "L*q2", {"column": 3, "found": "may not be used"}),
    (["parameters", "L", "value"], "2*m", {"column": 0, "found": "not a number"}),
]


def test_fields_of_a_window_are_checked_in_one_request(client: TestClient) -> None:
    before = client.get("/api/document").json()
    fields = [{"path": path, "text": text} for path, text, _ in FIELDS]
    checks = client.post("/api/expression", json={"fields": fields}).json()["checks"]
    for check, (_, text, expected) in zip(checks, FIELDS, strict=True):
        if check["ok"]:
            assert expected.items() <= check.items(), text
        else:
            assert check["error"]["column"] == expected["column"] and expected["found"] in check["error"]["found"], text
    assert client.get("/api/document").json() == before
    for none in (None, {}, ["L"], [{"path": "L", "text": "1"}], [{"text": "1"}] * 1001):
        answer = client.post("/api/expression", json={"fields": none})
        assert answer.status_code == 422 and "of the request is malformed" in answer.json()["error"]["object"]


def test_frequencies_of_a_beam_follow_from_its_section(client: TestClient) -> None:
    section = {"shape": "rectangle", "E": 70e9, "G": 26e9, "rho": 2700, "y": 0.02, "z": "0.005*L"}
    beam = {"length": "2*L", "section": section, "bend_y": 2, "twist": 1}
    figures = client.post("/api/beam", json={"beam": beam}).json()
    # L = 1: a strip 2 m long, 20 mm along y, 5 mm along z.
    assert figures["section"]["rhoA"] == pytest.approx(0.27)
    assert figures["section"]["EI_z"] == pytest.approx(70e9 * 0.005 * 0.02**3 / 12)
    first = 1.8751041**2 / (2 * np.pi * 4) * np.sqrt(70e9 * 0.02**2 / 12 / 2700)
    assert figures["frequencies"]["bend_y"][0] == pytest.approx(first)
    assert figures["frequencies"]["bend_z"][0] == pytest.approx(first / 4)
    twist = np.sqrt(figures["section"]["GJ"] / figures["section"]["rhoJ"]) / 8
    assert figures["frequencies"]["twist"] == pytest.approx([twist, 3 * twist, 5 * twist])
    tapered = {"length": 1, "rhoA": "1 - x/2", "EI_z": 10, "bend_y": 1}
    figures = client.post("/api/beam", json={"beam": tapered}).json()
    assert figures["frequencies"] == {} and figures["section"]["EI_z"] == 10 and "rhoA" not in figures["section"]
    for none in (None, {}, {"length": 1, "rhoA": -1, "E": 2}, {"length": "1 +", "rhoA": 1}):
        assert client.post("/api/beam", json={"beam": none}).status_code == 422


def test_the_document_can_be_changed_while_a_field_is_checked(
    client: TestClient, session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Thirteen fields of a large model were checked one by one, and OK waited for them all."""
    checking, changed = threading.Event(), threading.Event()
    in_time = []

    def slow(*_: object) -> dict:
        checking.set()
        in_time.append(changed.wait(60))
        return {"ok": True, "names": []}

    monkeypatch.setattr(session_module, "check_field", slow)
    asked = threading.Thread(target=lambda: client.post("/api/expression", json={"fields": [{"text": "1+1"}]}))
    asked.start()
    assert checking.wait(60)
    edit = {"op": "set", "path": ["parameters", "m", "value"], "value": 3}
    assert client.post("/api/edit", json={"revision": 1, "label": "mass", "edits": [edit]}).status_code == 200
    changed.set()
    asked.join()
    assert in_time == [True]


def test_shape_functions_are_served(client: TestClient) -> None:
    found = client.post("/api/shapes", json={"family": "polynomial", "modes": 2, "direction": "bend_y"}).json()
    assert found["curves"][0]["values"] == [x * x for x in found["xi"]] and found["curves"][0]["length"]
    user = {"family": "user", "modes": 1, "direction": "twist", "shapes": ["sin(xi)"]}
    assert client.post("/api/shapes", json=user).json()["curves"][0]["values"][0] == pytest.approx(0.0, abs=1e-12)
    for wrong in (
        *({"family": "fourier"}, {"direction": "x"}, {"modes": 41}, {"modes": "2"}, {"family": "hermite", "modes": 5}),
        *({"family": "user", "modes": 1, "shapes": [shape]} for shape in ("1/xi", {"xi": 3})),
    ):
        answer = client.post("/api/shapes", json=wrong)
        assert answer.status_code == 422 and answer.json()["error"]["remedy"], wrong


def test_parts_are_stored_listed_and_inserted(client: TestClient) -> None:
    assert client.get("/api/parts").json() == {"parts": []}
    kept = client.post("/api/parts", json={"name": "bar", "bodies": ["rocker"]}).json()
    assert kept["parts"][0]["bodies"] == ["rocker"]
    put = client.post(
        "/api/parts/insert", json={"revision": 1, "name": "bar", "parent": "crank", "frame": "end"}
    ).json()
    assert put["data"]["bodies"]["rocker2"]["joint"]["parent"] == "crank" and put["problems"] == []
    assert client.post("/api/parts/insert", json={"revision": put["revision"], "name": "no"}).status_code == 422


def test_an_internal_fault_of_the_server_is_reported_and_the_server_continues(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    with TestClient(application(session, TOKEN, PORT), BASE, raise_server_exceptions=False, headers=GRANTED) as client:
        with monkeypatch.context() as broken:
            broken.setattr(session.storage, "place", lambda _: 1 // 0)
            answer = client.post("/api/layout", json={})
        assert answer.status_code == 500 and answer.json()["error"]["found"] == "ZeroDivisionError"
        assert client.post("/api/layout", json={}).status_code == 200
        assert client.get("/api/nothing").json()["error"]["object"] == "no such address"


def test_data_are_a_mapping_whatever_the_text_is(client: TestClient) -> None:
    for text in ("", "symofros: 1\n\tbodies: {}", "{", "- 1", "a word", "~"):
        document = client.get("/api/document").json()
        answer = client.post("/api/text", json={"revision": document["revision"], "text": text})
        assert answer.status_code == 200, answer.text
        assert isinstance(answer.json()["data"], dict) and answer.json()["problems"]


def test_places_are_remembered_without_a_revision_and_of_another_document_refused(
    client: TestClient, folder: Path
) -> None:
    answer = client.post("/api/layout", json={"path": "other.yaml", "positions": {"bodies/crank": [1, 2]}})
    assert answer.status_code == 409 and not (folder / ".four_bar.editor.json").exists()
    answer = client.post("/api/layout", json={"path": "four_bar.yaml", "positions": {"bodies/crank": [1, 2]}})
    assert answer.json()["layout"]["bodies/crank"] == [1.0, 2.0]
    found = client.get("/api/document").json()
    assert found["layout"] == answer.json()["layout"] and found["revision"] == 1 and not found["can_undo"]
