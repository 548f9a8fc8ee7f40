"""Native code of a diagram's files runs from the page with the user's consent to its bytes, and never otherwise."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from symofros.errors import DescriptionError
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import Workspace, digest
from symofros.studio.editor.jobs.diagram_run import run_diagram
from symofros.studio.editor.jobs.request import Tell
from symofros.studio.editor.server.app import application
from tests.blocks.fmu.wilful import changed, wilful_unit
from tests.studio.editor.conftest import BASE, GRANTED, PORT, TOKEN, finished, over

PART = """symofros_diagram: 1
blocks:
  unit: {kind: fmu, file: wilful.fmu, period: 0.1}
inlets: {u: unit.pump_u}
outlets: {y: unit.pump_y}
"""
FED = """symofros_diagram: 1
simulation: {t_end: 0.2, record: 0.1}
blocks:
  wish: {kind: constant, value: 0.25, unit: N m}
  unit: {kind: fmu, file: wilful.fmu, period: 0.1, inputs: {pump_u: wish}}
parts:
  inner: {file: part.yaml, inputs: {u: wish}}
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return wilful_unit(tmp_path_factory.mktemp("wilful")).read_bytes()


@pytest.fixture
def unit(built: bytes, tmp_path: Path) -> Path:
    (tmp_path / "wilful.fmu").write_bytes(built)
    (tmp_path / "part.yaml").write_text(PART)
    (tmp_path / "fed.yaml").write_text(FED)
    return tmp_path / "wilful.fmu"


@pytest.fixture
def client(unit: Path) -> Iterator[TestClient]:
    session = Session(Workspace(unit.parent), unit.parent / "fed.yaml")
    with TestClient(application(session, TOKEN, PORT), base_url=BASE, headers=GRANTED) as found:
        yield found


def asked(client: TestClient) -> list[dict[str, Any]]:
    """What a run asks the user; nothing runs."""
    answer = client.post("/api/jobs", json={"kind": "run", "options": {"native": {"wilful.fmu": "x"}}})
    assert answer.status_code == 428 and "your consent alone" not in answer.json()["error"]["object"]
    assert "native code can do all that you can" in answer.json()["error"]["rule"]
    files: list[dict[str, Any]] = answer.json()["native"]
    return files


def consent(client: TestClient, *files: dict[str, Any], **more: Any) -> Any:
    return client.post("/api/consent", json={"files": [{**file, **more} for file in files]})


def test_a_run_asks_once_for_each_content_of_a_file(client: TestClient, unit: Path, built: bytes) -> None:
    [file] = asked(client)
    assert {key: file[key] for key in ("path", "blocks", "bytes", "digest")} == {
        "path": str(unit),
        "blocks": ["unit", "inner/unit"],
        "bytes": len(built),
        "digest": digest(built),
    }
    assert (file["owner"], file["author"], file["tool"]) == (unit.owner(), "A. Pump", "a compiler")
    assert consent(client, file).status_code == 200
    job = finished(client, "run")
    assert job["state"] == "done", job["error"]
    curves = {curve["name"]: curve["values"] for plot in job["result"]["plots"] for curve in plot["curves"]}
    assert curves["unit.pump_y"] == curves["inner/unit.pump_y"] == [0.25, 0.25, 0.25]
    # Other bytes are asked for; the consent to these stays.
    changed(unit)
    [other] = asked(client)
    assert other["digest"] == digest(unit.read_bytes()) != file["digest"]
    unit.write_bytes(built)
    assert over(client, client.post("/api/jobs", json={"kind": "run"}).json()["id"])["state"] == "done"


def test_consent_is_to_what_was_shown(client: TestClient, unit: Path, tmp_path: Path) -> None:
    [file] = asked(client)
    (tmp_path / "copy.fmu").write_bytes(unit.read_bytes())
    for refused in (
        consent(client, file, digest="0" * 64),
        consent(client, file, path=str(tmp_path / "copy.fmu")),
        consent(client, file, path=["wilful.fmu"]),
        consent(client),
        client.post("/api/consent", json={"files": True}),
        client.post("/api/consent", json={"files": ["wilful.fmu"]}),
    ):
        assert refused.status_code == 422 and refused.json()["error"]["remedy"], refused.text
    changed(unit)
    assert "has changed meanwhile" in consent(client, file).json()["error"]["object"]
    asked(client)


def test_a_page_without_the_token_neither_consents_nor_runs(client: TestClient) -> None:
    [file] = asked(client)
    for headers in ({"Authorization": ""}, {"Authorization": "Bearer other"}, {"Origin": "http://elsewhere.org"}):
        for address, body in (("consent", {"files": [file]}), ("jobs", {"kind": "run"})):
            answer = client.post(f"/api/{address}", json=body, headers=headers)
            assert answer.status_code in (401, 403), answer.text
    asked(client)


@pytest.mark.parametrize("native", [None, {}, "of another file", "of other bytes"])
def test_a_worker_runs_no_native_code_that_its_request_has_no_consent_to(unit: Path, native: Any) -> None:
    stated = {"of another file": {f"{unit}2": digest(unit.read_bytes())}, "of other bytes": {str(unit): "0" * 64}}
    request = {"file": str(unit.parent / "fed.yaml"), "text": FED, "options": {"native": {str(unit): True}}}
    given = stated.get(native, native) if isinstance(native, str) else native
    with pytest.raises(DescriptionError) as refused:
        run_diagram(request | ({} if given is None else {"native": given}), Tell(lambda message: None))
    assert "consent" in refused.value.problem.rule
